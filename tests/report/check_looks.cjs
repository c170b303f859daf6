// Checks how a report.html or player.html looks and moves, in headless Chromium: node check_looks.cjs CHECK PAGE [ARGUMENT...].
// Packages are found from the current folder. Prints what is wrong and exits with 1.
const assert = require('assert');
const { execFileSync } = require('child_process');
const { existsSync } = require('fs');
const { createRequire } = require('module');
const { delimiter, join } = require('path');
const { pathToFileURL } = require('url');
const { chromium } = createRequire(process.cwd() + '/')('playwright-core');

const [check, file, ...rest] = process.argv.slice(2);
const url = pathToFileURL(file).href;

const atRest = (page) => page.waitForFunction(() => (window.sdmPage ?? window.sdmPlayer).view.atRest);

/// How the last picture was drawn.
const drawn = (page) =>
  page.evaluate(() => {
    const { view } = window.sdmPage ?? window.sdmPlayer;
    const { triangles, points } = view.renderer.info.render;
    return { width: view.canvas.width, elements: triangles + points, moving: document.getElementById('view').classList.contains('moving') };
  });

const checks = {
  // Where pictures take long, those of a drag and of a slider have fewer pixels and fewer elements; what is under the
  // cursor stays. Where they do not, all pictures are fine.
  async drags(open, most) {
    const page = await open({});
    await atRest(page);
    const fine = await drawn(page);
    const pace = (milliseconds) =>
      page.evaluate((time) => {
        const { pace } = window.sdmPage.view;
        pace.took = () => (pace.fine = time); // instead of what this machine takes
        pace.took();
      }, milliseconds);
    const canvas = await page.locator('#canvas').boundingBox();
    const x = canvas.x + canvas.width / 2;
    const y = canvas.y + canvas.height / 2;
    const pictures = async (change) => {
      const seen = [];
      for (let i = 0; i < 5; ++i) {
        await change(i);
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
        seen.push(await drawn(page));
      }
      return seen;
    };
    const drag = async () => {
      await page.mouse.move(x, y);
      await page.mouse.down();
      const seen = await pictures((i) => page.mouse.move(x + 6 * i + 6, y));
      await page.mouse.up();
      return seen;
    };
    const slide = () => pictures((i) => page.fill('#tolerance', String(500 + 20 * i)));
    for (const move of [drag, slide]) {
      await pace(1000);
      const place = () => page.evaluate(() => window.sdmPage.inspect(...window.sdmPage.middle()));
      const coarse = (await move()).pop();
      const under = await place();
      assert(coarse.moving && coarse.width <= fine.width / 2, `${coarse.width} pixels of ${fine.width}`);
      assert(coarse.elements > 100 && coarse.elements <= Number(most), `${coarse.elements} of ${fine.elements} are drawn`);
      await atRest(page);
      assert.deepStrictEqual(await drawn(page), fine);
      assert.deepStrictEqual(await place(), under);
      await pace(1);
      for (const picture of await move()) assert.deepStrictEqual(picture, fine);
      await atRest(page);
    }
    assert(fine.elements > Number(most), 'the part is too small for this test');
  },
};

(async () => {
  const browser = await chromium.launch({
    executablePath: process.env.PATH.split(delimiter).map((folder) => join(folder, 'chromium')).find(existsSync),
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  const faults = [];
  // The page in a window of its own, when it is ready.
  const open = async ({ width = 1280, height = 800, scheme = 'light', touch = false }) => {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, hasTouch: touch, isMobile: touch });
    const page = await context.newPage();
    page.on('console', (message) => faults.push(`console: ${message.text()}`));
    page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
    page.on('request', (request) => {
      if (request.url() !== url && !request.url().startsWith('data:')) faults.push(`request: ${request.url()}`);
    });
    await page.goto(url);
    await page.waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 });
    return page;
  };
  try {
    await checks[check](open, ...rest);
    assert.deepStrictEqual(faults, []);
  } finally {
    await browser.close();
  }
})().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
