// The door of JavaScript for doors.py, as call_options.cpp, for the calls that this door has, with the package for npm in the folder
// SDM_PACKAGE.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const sdm = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const library = await sdm.start({ full: true });
const kOfSurface = ['resolution', 'atlas', 'gutter', 'strict_uv', 'max_stretch'];
const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/** A number, a flag or a direction, if that is what a user would give. */
function value(text) {
  if (text === 'true') return true;
  if (text.includes(',')) return text.split(',').map(Number);
  return text !== '' && (text === 'nan' || !Number.isNaN(Number(text))) ? Number(text) : text;
}

const meshes = new Map();
function mesh(file) {
  if (!meshes.has(file)) meshes.set(file, library.readMesh(new Uint8Array(readFileSync(file)), file));
  return meshes.get(file);
}

/** Whether a name is another one without one letter. */
function similar(known, name) {
  for (let i = 0; i < known.length; ++i) if (known.slice(0, i) + known.slice(i + 1) === name) return true;
  return false;
}

/** The options of the surface, and the others. Unknown names go where the option was meant for: each of them lacks a letter. */
function divided(words) {
  const [ofSurface, others] = [{}, {}];
  for (const [name, text] of words) {
    const target = kOfSurface.some((known) => known === name || similar(known, name)) ? ofSurface : others;
    target[camel(name)] = value(text);
  }
  return [ofSurface, others];
}

const isOfOptions = (error) => /^unknown option| must be | excludes /.test(error.message);

/** Here a surface is made by a call of its own: where there is no room for it, options of the map are refused first, as elsewhere. */
function surfaceOf(on, sites, options, mapOptions) {
  try {
    return new library.Surface(on.positions, on.indices, options);
  } catch (error) {
    if (isOfOptions(error)) throw error;
    try {
      new library.Surface(on.positions, on.indices).map(sites, mapOptions);
    } catch (ofMap) {
      if (isOfOptions(ofMap)) throw ofMap;
    }
    throw error;
  }
}

/** The map of a surface to sites that are made of the last file. */
function statistics(files, words, measure) {
  const [ofSurface, ofMap] = divided(words);
  const [on, to] = [mesh(files[0]), mesh(files.at(-1))];
  const sites = new library.Sites(to.positions, to.indices);
  const surface = surfaceOf(on, sites, ofSurface, { ...measure, ...ofMap });
  const map = surface.map(sites, { ...measure, ...ofMap });
  const s = map.statistics();
  const numbers = [s.texels, s.min, s.max, s.mean, s.rms];
  const { sign } = map;
  for (const object of [map, surface, sites]) object.dispose();
  return { sign, numbers };
}

/** Separations of all pairs, and the bounds of the depths of those that collide. */
function pairs(files, words) {
  const options = divided(words)[1];
  const [separations, depths] = [[], []];
  for (let i = 0; i < files.length; ++i)
    for (let k = i + 1; k < files.length; ++k) {
      const pair = new library.Pair(mesh(files[i]), mesh(files[k]), options);
      separations.push(pair.separation().value);
      const depth = pair.colliding() ? pair.penetrationDepth() : null;
      if (depth) depths.push(depth.lower, depth.upper);
      pair.dispose();
    }
  return [...separations, ...depths];
}

const kCalls = {
  map: (files, words) => {
    const { sign, numbers } = statistics(files, words, {});
    return [sign, ...numbers];
  },
  self: (files, words) => statistics(files, words, { measure: 'self' }).numbers,
  thickness: (files, words) => statistics(files, words, { measure: 'thickness' }).numbers,
  bodies: pairs,
};

for (const line of readFileSync(0, 'utf8').split('\n').slice(0, -1)) {
  const [options, files] = line.split(' -- ');
  const [call, ...words] = options.split(' ').filter(Boolean);
  try {
    const result = kCalls[call](files.split(' '), words.map((word) => word.split('=')));
    console.log(result.map((x) => (typeof x === 'number' ? x.toPrecision(9) : x)).join(' '));
  } catch (error) {
    console.log(`error ${error.message}`);
  }
}
