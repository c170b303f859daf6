// Writes the types of what C++ declares: node declared_types.mjs FOLDER FULL.linked.wasm writes FOLDER/declared.d.ts.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [folder, file] = process.argv.slice(2);
const module = new WebAssembly.Module(readFileSync(file));
const memory = new WebAssembly.Memory({ initial: 64, maximum: 65536, shared: true });
const imports = { env: { memory } };
for (const { module: from, name, kind } of WebAssembly.Module.imports(module))
  if (kind === 'function') (imports[from] ??= {})[name] = () => (name === 'threads' ? 1 : 0);
const { exports } = new WebAssembly.Instance(module, imports);
exports.__wasm_call_ctors();
// Result of module/result.h: error, message, names, numbers and count, then the one array, its address and its bytes.
const result = new Uint32Array(memory.buffer, exports.sdm_declared_types() >>> 0, 10);
const text = new TextDecoder().decode(new Uint8Array(memory.buffer).slice(result[8], result[8] + result[9]));
if (result[0] !== 0 || !text.endsWith('}\n')) throw new Error('the module does not state its declarations');
writeFileSync(join(folder, 'declared.d.ts'), text);
