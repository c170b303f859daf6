// Maps by WebGPU in headless Chromium, whose SwiftShader computes on the processor, beside those of the native library. SDM_PACKAGE:
// the folder of the package; SDM_REFERENCE: that of js_reference's files; SDM_NODE_PACKAGES: that with playwright-core.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { launched } from './chromium.mjs';
import { served } from './server.mjs';

const { SDM_REFERENCE } = process.env;
let browser, server, page;
const faults = [];

before(async () => {
  browser = await launched(['--enable-unsafe-webgpu']);
  server = await served({});
  page = await browser.newPage();
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  await page.goto(`http://127.0.0.1:${server.address().port}/page.html?gpu_page.mjs`);
  await page.waitForFunction(() => window.checks, null, { timeout: 60000 });
  assert(await page.evaluate(() => window.checks.hasDevice()), 'this Chromium has no WebGPU: the engine gpu is not tested');
});
after(async () => {
  await browser?.close();
  server?.closeAllConnections?.();
  server?.close();
});

test('distances are those of the native engines', { timeout: 800000 }, async () => {
  const pairs = JSON.parse(readFileSync(join(SDM_REFERENCE, 'pairs.json'), 'utf8'));
  const names = readdirSync(SDM_REFERENCE).filter((name) => /\.(apart|o2)\.|\.reference\./.test(name));
  const files = Object.fromEntries(names.map((name) => [name, readFileSync(join(SDM_REFERENCE, name)).toString('base64')]));
  await page.evaluate(([given, of]) => window.checks.agrees(given, of), [pairs, files]);
});
for (const name of ['blocks', 'refuses', 'aborts'])
  test(name, { timeout: 800000 }, () => page.evaluate((check) => window.checks[check](), name));
test('no error of the page', () => assert.deepEqual(faults, []));
