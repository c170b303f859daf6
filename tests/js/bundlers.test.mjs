// One app that imports the package, with each bundler and without one, in headless Chromium: it measures what it measures in Node.
// With `sdm` as a registry would install it, without settings but those of docs/javascript.md, and as a linked folder.
// SDM_PACKAGE: the folder of the package; SDM_NODE_PACKAGES: that with the bundlers, playwright-core and three.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, symlinkSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, extname, join, normalize } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { launched } from './chromium.mjs';

const { SDM_PACKAGE, SDM_NODE_PACKAGES } = process.env;
const require = createRequire(SDM_NODE_PACKAGES + '/');
const imported = (name) => import(pathToFileURL(require.resolve(name)));
const here = dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'sdm-bundlers-'));
const apps = { installed: join(folder, 'installed'), linked: join(folder, 'linked') };
let browser, expected;

/** The folder of an app. Its other packages are those of SDM_NODE_PACKAGES. */
function makeApp(app, install) {
  mkdirSync(join(app, 'node_modules'), { recursive: true });
  install(SDM_PACKAGE, join(app, 'node_modules/sdm'));
  symlinkSync(join(SDM_NODE_PACKAGES, 'node_modules/three'), join(app, 'node_modules/three'));
  copyFileSync(join(here, 'bundled_app.js'), join(app, 'app.js'));
  writeFileSync(join(app, 'package.json'), '{ "type": "module", "dependencies": { "sdm": "*", "three": "*" } }');
  writeFileSync(join(app, 'main.js'), "import { measured } from './app.js';\nwindow.result = measured();\n");
  writeFileSync(join(app, 'index.html'), '<!doctype html><link rel="icon" href="data:,"><script type="module" src="./main.js"></script>');
}

before(async () => {
  makeApp(apps.installed, (from, to) => cpSync(from, to, { recursive: true }));
  makeApp(apps.linked, symlinkSync);
  ({ measured: expected } = await import(pathToFileURL(join(apps.installed, 'app.js'))));
  expected = await expected();
  assert.ok(expected.verdict === 'PASS' && expected.reported && expected.distances.length > 1000, JSON.stringify(expected).slice(0, 300));
  browser = await launched();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
async function served(root, fallback) {
  const server = createServer((request, response) => {
    let file = join(root, normalize(new URL(request.url, 'http://localhost').pathname));
    if (!statSync(file, { throwIfNoEntry: false })?.isFile()) file = fallback;
    if (!file) return response.writeHead(404).end();
    response.writeHead(200, { 'content-type': types[extname(file)] ?? 'text/plain' }).end(readFileSync(file));
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}/index.html`, close: () => server.close().closeAllConnections() };
}

/** Opens the page and compares what the app has measured. */
async function runs({ url, close }) {
  const page = await browser.newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && faults.push(`console: ${message.text()}`));
  page.on('response', (response) => response.status() >= 400 && faults.push(`${response.status()}: ${response.url()}`));
  try {
    await page.goto(url);
    assert.deepEqual(await page.waitForFunction(() => window.result, null, { timeout: 30000 }).then((result) => result.jsonValue()).catch(() => faults), expected);
    assert.deepEqual(faults, []);
  } finally {
    await page.close();
    await close();
  }
}

/** A page beside what a bundler wrote. */
function pageOf(out, script) {
  writeFileSync(join(out, 'index.html'), `<!doctype html><link rel="icon" href="data:,"><script type="module" src="./${script}"></script>`);
  return served(out);
}

// How each bundler is called for an app, and with which settings if the package is linked. Each returns its warnings. Vite alone
// minimizes the program and omits what it does not use: three.js takes webpack 10 s and Rollup 3 s.
const bundlers = {
  async vite(root, linked) {
    const { build, createLogger } = await imported('vite');
    const warnings = [];
    const customLogger = { ...createLogger('silent'), warn: (text) => warnings.push(text), warnOnce: (text) => warnings.push(text) };
    await build({ root, base: './', customLogger, build: { outDir: 'vite' }, resolve: linked ? { dedupe: ['three'] } : {} });
    return { warnings, page: () => served(join(root, 'vite')) };
  },
  async webpack(root, linked) {
    const out = join(root, 'webpack');
    const statistics = await new Promise((resolve, reject) =>
      require('webpack')(
        { mode: 'production', context: root, entry: './main.js', output: { path: out }, performance: false, optimization: { minimize: false }, resolve: linked ? { symlinks: false } : {} },
        (error, done) => (error ? reject(error) : resolve(done))));
    const { errors, warnings } = statistics.toJson({ all: false, errors: true, warnings: true });
    return { warnings: [...errors, ...warnings].map(({ message }) => message), page: () => pageOf(out, 'main.js') };
  },
  async rollup(root, linked) {
    const { rollup } = await imported('rollup');
    const { nodeResolve } = await imported('@rollup/plugin-node-resolve');
    const { importMetaAssets } = await imported('@web/rollup-plugin-import-meta-assets');
    const warnings = [];
    const plugins = [nodeResolve({ rootDir: root, dedupe: linked ? ['three'] : [] }), importMetaAssets()];
    const bundle = await rollup({ input: join(root, 'main.js'), plugins, treeshake: false, onwarn: ({ message }) => warnings.push(message) });
    await bundle.write({ dir: join(root, 'rollup'), format: 'es' });
    return { warnings, page: () => pageOf(join(root, 'rollup'), 'main.js') };
  },
  async esbuild(root, linked) {
    const out = join(root, 'esbuild');
    const { warnings } = await require('esbuild').build({
      entryPoints: [join(root, 'main.js')], bundle: true, format: 'esm', outdir: out, logLevel: 'silent', preserveSymlinks: linked });
    for (const file of ['worker.js', 'sdm_core.wasm', 'sdm_full.wasm', 'report_page.txt']) copyFileSync(join(root, 'node_modules/sdm', file), join(out, file));
    return { warnings: warnings.map(({ text }) => text), page: () => pageOf(out, 'main.js') };
  },
};

for (const [name, bundle] of Object.entries(bundlers))
  // Rollup, which is slow, needs the same plugins for both.
  for (const kind of name === 'rollup' ? ['linked'] : ['installed', 'linked'])
    test(`${name}, ${kind}`, { timeout: 120000 }, async () => {
      const { warnings, page } = await bundle(apps[kind], kind === 'linked');
      assert.deepEqual(warnings, []);
      await runs(await page());
    });

for (const kind of ['installed', 'linked'])
  test(`the server of vite, ${kind}`, { timeout: 120000 }, async () => {
    const { createServer: begin } = await imported('vite');
    const root = apps[kind];
    const ofLink = { server: { fs: { allow: [root, SDM_PACKAGE] } }, resolve: { dedupe: ['three'] } };
    const { server: more, ...settings } = kind === 'linked' ? ofLink : {};
    const server = await begin({ root, logLevel: 'silent', server: { host: '127.0.0.1', port: 0, ...more }, ...settings });
    await server.listen();
    await runs({ url: `http://127.0.0.1:${server.httpServer.address().port}/`, close: () => server.close() });
  });

test('a server that has a page in place of what it does not find', { timeout: 120000 }, async () => {
  const root = join(apps.installed, 'esbuild');
  const { url, close } = await served(root, join(root, 'index.html'));
  rmSync(join(root, 'sdm_core.wasm'));
  const page = await browser.newPage();
  await page.goto(url);
  const error = await page.waitForFunction(() => window.result?.catch((reason) => reason.message)).then((result) => result.jsonValue());
  assert.equal(error, `what the server has at ${new URL('sdm_core.wasm', url)} is no WebAssembly: it must be the file sdm_core.wasm of this package`);
  await page.close();
  close();
});

test('Node, linked', { timeout: 120000 }, () => {
  const file = join(apps.linked, 'node.js');
  writeFileSync(file, "import { measured } from './app.js';\nconsole.log(JSON.stringify(await measured()));\n");
  const found = execFileSync(process.execPath, ['--preserve-symlinks', '--preserve-symlinks-main', file]);
  assert.deepEqual(JSON.parse(found), expected);
});

test('no bundler: an import map', { timeout: 120000 }, async () => {
  const root = apps.installed;
  const map = { imports: { sdm: './node_modules/sdm/index.js', 'sdm/three': './node_modules/sdm/three.js', three: './node_modules/three/build/three.module.js' } };
  writeFileSync(join(root, 'plain.html'), readFileSync(join(root, 'index.html'), 'utf8').replace('<script', `<script type="importmap">${JSON.stringify(map)}</script><script`));
  const server = await served(root);
  await runs({ ...server, url: server.url.replace('index.html', 'plain.html') });
});
