// A mesh file that the build puts into the program.
declare module '*.ply' {
  const bytes: Uint8Array;
  export default bytes;
}
