// The door of JavaScript for doors.py: node map_options.mjs MESH MESH, as call_options.cpp for maps, with the package for npm in the folder
// SDM_PACKAGE.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const sdm = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'index.js')));
const library = await sdm.start({ full: true });
const kOfSurface = ['resolution', 'atlas', 'gutter', 'strict_uv', 'max_stretch'];
const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/** A number, a flag or a direction, if that is what a user would give. */
const value = (text) => (text === 'true' ? true : text.includes(',') ? text.split(',').map(Number) : text !== '' && (text === 'nan' || !Number.isNaN(Number(text))) ? Number(text) : text);

const mesh = (file) => library.readMesh(new Uint8Array(readFileSync(file)), file);
const [on, to] = process.argv.slice(2).map(mesh);
const sites = new library.Sites(to.positions, to.indices);
for (const line of readFileSync(0, 'utf8').split('\n').slice(0, -1)) {
  const [ofSurface, ofMap] = [{ resolution: 64 }, {}];
  for (const word of line.split(' ').filter(Boolean)) {
    const [name, text] = word.split('=');
    // Unknown names go where the option was meant for: each of them lacks a letter.
    const target = kOfSurface.some((known) => known.length - name.length < 2 && known.startsWith(name[0]) && (known === name || similar(known, name)));
    (target ? ofSurface : ofMap)[camel(name)] = value(text);
  }
  try {
    const surface = new library.Surface(on.positions, on.indices, ofSurface);
    const map = surface.map(sites, ofMap);
    const s = map.statistics();
    console.log([map.sign, s.texels, ...[s.min, s.max, s.mean, s.rms].map((x) => x.toPrecision(9))].join(' '));
    map.dispose();
    surface.dispose();
  } catch (error) {
    console.log(`error ${error.message}`);
  }
}

/** Whether a name is another one without one letter. */
function similar(known, name) {
  for (let i = 0; i < known.length; ++i) if (known.slice(0, i) + known.slice(i + 1) === name) return true;
  return false;
}
