// Writes the shaders of the gpu engine as text: node wgsl.mjs SHADERS FOLDER writes FOLDER/wgsl.js and FOLDER/wgsl.d.ts. Without
// comments and indentation, which would be a third of what is loaded.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const kNames = ['faces', 'nearest_first', 'part', 'tile_balls', 'closest_tiles', 'closest_faces'];

const [from, to] = process.argv.slice(2);
const short = (text) => text.replace(/\s*\/\/.*/g, '').replace(/\n\s+/g, '\n').trimStart();
const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());
const texts = Object.fromEntries(kNames.map((name) => [camel(name), short(readFileSync(join(from, `${name}.wgsl`), 'utf8'))]));
writeFileSync(join(to, 'wgsl.js'), `export const kWgsl = ${JSON.stringify(texts)};\n`);
writeFileSync(join(to, 'wgsl.d.ts'), `/** The files of shaders/. */\nexport declare const kWgsl: Record<${Object.keys(texts).map((name) => `'${name}'`).join(' | ')}, string>;\n`);
