// What the package promises to weigh. SDM_PACKAGE: its folder.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { brotliCompressSync } from 'node:zlib';

const kLargestModule = 300e3, kLargestPackage = 1.65e6;

test('the module is small as Brotli', () => {
  const bytes = brotliCompressSync(readFileSync(join(process.env.SDM_PACKAGE, 'sdm_core.wasm'))).length;
  assert.ok(bytes <= kLargestModule, `sdm_core.wasm: ${bytes} bytes`);
});

test('the package is small', () => {
  const [{ size, files }] = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json', '--offline'], { cwd: process.env.SDM_PACKAGE }));
  assert.ok(files.some(({ path }) => path === 'sdm_full.wasm'));
  assert.ok(size <= kLargestPackage, `npm pack: ${size} bytes`);
});
