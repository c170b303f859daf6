// Makes the calls of javascript_cases.mjs with the npm package in the folder SDM_PACKAGE, and prints a line of JSON for each: its text
// and what it returns. Run by compare.py, with the folder of the inputs and a text that the names of cases contain.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { calls } from './javascript_cases.mjs';

const entry = JSON.parse(readFileSync(join(process.env.SDM_PACKAGE, 'package.json'))).exports['.'];
const sdm = await import(pathToFileURL(join(process.env.SDM_PACKAGE, entry.node ?? entry.default)));  // of older packages
const [folder, only] = process.argv.slice(2);

// What objects hold that is no result.
const kInternal = ['module', 'free', 'address', 'handle', 'surface', 'sites', 'facts', 'first', 'numbers', 'memoryBytes'];
// Arrays of so many elements are written whole.
const kWhole = 16;

/** Numbers that JSON has, and words for the others. */
const number = (value) => (Number.isFinite(value) ? value : String(value));

function typedArray(values) {
  const found = { type: values.constructor.name, length: values.length };
  if (values.length <= kWhole) return { ...found, values: Array.from(values, (v) => (typeof v === 'bigint' ? String(v) : number(v))) };
  found.hash = createHash('sha256').update(new Uint8Array(values.buffer, values.byteOffset, values.byteLength)).digest('hex').slice(0, 16);
  if (typeof values[0] === 'bigint') return found;
  let finite = 0, sum = 0, least = Infinity, largest = -Infinity;
  for (const v of values) {
    if (!Number.isFinite(v)) continue;
    ++finite;
    sum += v;
    least = Math.min(least, v);
    largest = Math.max(largest, v);
  }
  return { ...found, finite, least: number(least), largest: number(largest), mean: number(sum / finite) };
}

/** Of objects: their class, and all properties and getters. */
function described(value, depth = 0) {
  if (value === null || value === undefined) return null;
  if (typeof value === 'bigint' || typeof value === 'function') return String(value).slice(0, 40);
  if (typeof value === 'number') return number(value);
  if (typeof value !== 'object') return value;
  if (ArrayBuffer.isView(value)) return typedArray(value);
  if (Array.isArray(value)) return value.map((v) => described(v, depth));
  if (value instanceof Error) return { error: value.constructor.name, kind: value.kind ?? null, message: value.message };
  const found = {}, prototype = Object.getPrototypeOf(value);
  if (prototype !== Object.prototype) found.class = prototype?.constructor.name;
  if (depth > 4) return found;
  const names = Object.keys(value);
  for (let p = prototype; p && p !== Object.prototype; p = Object.getPrototypeOf(p))
    for (const [name, property] of Object.entries(Object.getOwnPropertyDescriptors(p))) if (property.get) names.push(name);
  for (const name of names) {
    if (kInternal.includes(name)) continue;
    try {
      found[name] = described(value[name], depth + 1);
    } catch (error) {
      found[name] = described(error);
    }
  }
  return found;
}

const core = await sdm.start({ threads: 1 }), full = await sdm.start({ threads: 2, full: true });
const file = (name) => new Uint8Array(readFileSync(join(folder, name)));
const mesh = (name) => full.readMesh(file(`${name}.ply`), `${name}.ply`);
const given = { sdm, core, full, file };
for (const name of ['ball', 'larger', 'beside', 'apart', 'box', 'box2', 'plate', 'dented', 'ground', 'soup', 'scan']) {
  const { positions, indices } = mesh(name);
  given[name] = { positions, indices, all: [positions, indices] };
}
for (const call of calls) {
  const name = call.toString();
  if (!name.includes(only)) continue;
  let value;
  try {
    value = await call(given);
  } catch (error) {
    value = error;
  }
  console.log(JSON.stringify([name, { value: described(value) }]));
}
process.exit(0);
