// The module as it is in the package, with a memory that is not shared: node own_memory.mjs PACKAGE FROM TO.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [folder, from, to] = process.argv.slice(2);
const { withMemory } = await import(pathToFileURL(join(folder, 'shared_memory.js')));
writeFileSync(to, withMemory(readFileSync(from), false));
