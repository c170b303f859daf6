// What the package promises to weigh. SDM_PACKAGE: its folder.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { brotliCompress } from 'node:zlib';

const kLargestModule = 300e3, kLargestPackage = 1.67e6;

const root = join(dirname(fileURLToPath(import.meta.url)), '../..');

test('the module is small as Brotli, and both are as large as stated', async () => {
  const compressed = promisify(brotliCompress);
  const [core, full] = await Promise.all(
    ['sdm_core.wasm', 'sdm_full.wasm'].map(async (name) => (await compressed(readFileSync(join(process.env.SDM_PACKAGE, name)))).length));
  assert.ok(core <= kLargestModule, `sdm_core.wasm: ${core} bytes`);
  for (const file of ['js/README.md', 'docs/javascript.md']) {
    const [, ...stated] = /larger(?: module \(|: )(\d+) kB as Brotli[^.]*?(\d+) kB/.exec(readFileSync(join(root, file), 'utf8'));
    [full, core].forEach((bytes, i) => assert.ok(Math.abs(1e3 * stated[i] - bytes) <= 10e3, `${file}: ${stated[i]} kB, but ${bytes} bytes`));
  }
});

test('the package is small', () => {
  const [{ size, files }] = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json', '--offline'], { cwd: process.env.SDM_PACKAGE }));
  assert.ok(files.some(({ path }) => path === 'sdm_full.wasm'));
  assert.ok(size <= kLargestPackage, `npm pack: ${size} bytes`);
});
