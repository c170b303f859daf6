// The package in headless Chromium: from a file, and from a server on this machine, with and without isolation from other origins
// (without it, memory cannot be shared). SDM_PACKAGE: the folder of the package; SDM_REFERENCE: that of js_reference's files;
// SDM_NODE_PACKAGES: that with playwright-core, esbuild and three.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { launched } from './chromium.mjs';
import { served } from './server.mjs';
import { ball } from './shapes.mjs';

const { SDM_PACKAGE, SDM_REFERENCE, SDM_NODE_PACKAGES } = process.env;
const require = createRequire(SDM_NODE_PACKAGES + '/');
const { build } = require('esbuild');
const here = dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'sdm-js-'));
let browser;

before(async () => {
  browser = await launched();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

const reference = () => Object.fromEntries(readdirSync(SDM_REFERENCE).map((name) => [name, readFileSync(join(SDM_REFERENCE, name)).toString('base64')]));
/** A page with everything in it, as it opens from a disk. */
async function filePage() {
  const { outputFiles } = await build({
    stdin: { contents: readFileSync(join(here, 'page.mjs'), 'utf8').replace('/package/index.js', join(SDM_PACKAGE, 'index.js')), resolveDir: here },
    bundle: true, format: 'iife', write: false, target: 'es2022', logLevel: 'error', logOverride: { 'empty-import-meta': 'silent' },
  });
  const text = (value) => JSON.stringify(value).replaceAll('<', '\\u003c');
  const files = {
    script: readFileSync(join(SDM_PACKAGE, 'worker.js'), 'utf8'),
    core: readFileSync(join(SDM_PACKAGE, 'sdm_core.wasm')).toString('base64'),
    full: readFileSync(join(SDM_PACKAGE, 'sdm_full.wasm')).toString('base64'),
  };
  const file = join(folder, 'page.html');
  writeFileSync(file, `<!doctype html><meta charset="utf-8"><script>window.embedded = ${text(files)};</script><script>${outputFiles[0].text.replaceAll('</script', '<\\/script')}</script>`);
  return pathToFileURL(file).href;
}

async function runChecks(t, url, { isolated, script }) {
  const page = await (await browser.newContext()).newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  page.on('console', (message) => message.type() === 'error' && !/404/.test(message.text()) && faults.push(`console: ${message.text()}`));
  await page.goto(url);
  await page.waitForFunction(() => window.checks, null, { timeout: 30000 });
  await page.evaluate((files) => window.checks.setReference(files), reference());
  const facts = await page.evaluate(() => window.checks.begin());
  assert.deepEqual(facts, { sharesMemory: isolated, threads: isolated ? 2 : 1 });
  for (const check of ['agrees', 'namesFaults', 'movesBuffers', 'apart', 'others', 'abortsMaps', 'abortsAnything', 'refits', 'divides', 'measures'])
    await t.test(check, () => page.evaluate((name) => window.checks.run(name), check));
  await t.test('failsToStart', () => page.evaluate((bad) => window.checks.failsToStart(bad), script));
  await t.test('the main thread computes without waiting', () => page.evaluate(() => window.checks.synchronous()));
  assert.deepEqual(faults, []);
  await page.context().close();
}

test('from a file', { timeout: 800000 }, async (t) => runChecks(t, await filePage(), { isolated: false, script: 'broken blob' }));

for (const isolated of [false, true])
  test(`from a server, ${isolated ? 'isolated' : 'not isolated'}`, { timeout: 800000 }, async (t) => {
    const server = await served(isolated ? { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' } : {});
    try {
      await runChecks(t, `http://127.0.0.1:${server.address().port}/page.html`, { isolated, script: '/nowhere.js' });
    } finally {
      server.closeAllConnections?.();
      server.close();
    }
  });

test('a report opens', { timeout: 120000 }, async () => {
  const { start } = await import(pathToFileURL(join(SDM_PACKAGE, 'node.js')));
  const sdm = await start({ full: true });
  const part = ball(40), other = ball(40, 0.9);
  const surface = new sdm.Surface(part.positions, part.indices, { resolution: 256 });
  const map = surface.map(new sdm.Sites(other.positions, other.indices));
  const file = join(folder, 'report.html');
  writeFileSync(file, await map.report({ tolerance: [-0.2, 0.2], units: 'mm', names: ['part.stl', 'nominal.stl'] }));
  const page = await (await browser.newContext()).newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('console', (message) => message.type() === 'error' && faults.push(message.text()));
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 });
  assert.match(await page.textContent('#verdict'), /PASS/);
  assert.match(await page.textContent('body'), /part\.stl/);
  assert.deepEqual(faults, []);
});

test('a map on a mesh of three.js', { timeout: 120000 }, async () => {
  const { outputFiles } = await build({
    entryPoints: [join(here, 'three_page.mjs')], bundle: true, format: 'iife', write: false, target: 'es2022',
    nodePaths: [join(SDM_NODE_PACKAGES, 'node_modules')], alias: { sdm: join(SDM_PACKAGE, 'index.js'), 'sdm/three': join(SDM_PACKAGE, 'three.js') },
    logLevel: 'error', logOverride: { 'empty-import-meta': 'silent' },
  });
  const page = await (await browser.newContext({ viewport: { width: 400, height: 400 } })).newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('console', (message) => message.type() === 'error' && faults.push(message.text()));
  await page.setContent('<style>body { margin: 0 }</style>');
  const given = { script: readFileSync(join(SDM_PACKAGE, 'worker.js'), 'utf8'), core: readFileSync(join(SDM_PACKAGE, 'sdm_core.wasm')).toString('base64') };
  await page.evaluate((files) => void (window.embedded = files), given);
  await page.addScriptTag({ content: outputFiles[0].text });
  const seen = await page.evaluate(() => window.seen());
  // Half of the ball is 0.1 from the other one: warm above the tolerance, green within, and grey of no value nowhere.
  assert.ok(seen.above > 0.3 && seen.within > 0.3 && seen.above + seen.within > 0.97, JSON.stringify(seen));
  if (process.env.SDM_PICTURES) await page.screenshot({ path: join(process.env.SDM_PICTURES, 'three.png') });
  // The bands of one limit; what exceeds it by less than the accuracy is within it.
  const none = null;  // infinity is no JSON
  for (const [tolerance, range, accuracy, expected] of [
    [[none, 0.1], [-1, 1], 0.01, { '-5': [225, 243, 233], 0.09: [66, 158, 122], 0.105: [66, 158, 122], 0.2: [252, 193, 82], 1: [165, 15, 21] }],
    [[0.5, none], [0, 1], 0.01, { 0.9: [225, 243, 233], 0.6: [66, 158, 122], 0.495: [66, 158, 122], 0.4: [114, 172, 221], 0: [8, 48, 107] }],
    [[-0.1, 0.2], [-1, 1], 0, { 0.1: [122, 196, 161], '-0.1001': [150, 200, 235], NaN: [128, 130, 134] }],
  ]) {
    const colors = await page.evaluate(([distances, [least, most], options]) =>
      window.colorsOf(distances.map(Number), { ...options, tolerance: [least ?? -Infinity, most ?? Infinity] }), [Object.keys(expected), tolerance, { range, accuracy }]);
    Object.entries(expected).forEach(([d, color], i) =>
      color.forEach((x, k) => assert.ok(Math.abs(x - colors[i][k]) <= 3, `${d} is ${colors[i]}, not ${color}`)));
  }
  // Without a range, the scale is that of all pictures.
  const above = Array.from({ length: 100 }, (_, i) => i / 50), few = [...above, -0.1, -0.1];
  for (const [distances, options, expected] of [
    [above, {}, ['viridis', 0, 2]],
    [few, {}, ['sequential', -0.5, 2]],
    [few, { accuracy: 0.2 }, ['viridis', 0, 2]],
    [few, { range: [-1, 1] }, ['diverging', -1, 1]],
    [[...above, ...above.map((d) => -d)], {}, ['diverging', -2, 2]],
    [few, { tolerance: [-1, 3] }, ['sequential', -4, 6]],
  ])
    assert.deepEqual(await page.evaluate(([d, o]) => window.scaleOf(d, o), [distances, options]), expected);
  assert.deepEqual(faults, []);
});
