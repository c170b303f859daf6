// Pages in headless Chromium. Packages are found from the current folder.
const assert = require('assert');
const { existsSync } = require('fs');
const { createRequire } = require('module');
const { delimiter, join } = require('path');
const { chromium } = createRequire(process.cwd() + '/')('playwright-core');

const kPatience = 120000; // milliseconds, on a machine that does other things

function findBrowser() {
  const found = process.env.PATH.split(delimiter).map((folder) => join(folder, 'chromium-headless-shell')).find(existsSync);
  assert(found, 'chromium-headless-shell is needed for this test (Debian package of that name)');
  return found;
}

/// Opens a page in a context; what it logs, throws and requests beside itself is added to `faults`. Returns when the page
/// is ready.
async function opened(context, url, faults) {
  const page = await context.newPage();
  page.setDefaultTimeout(kPatience);
  // That pixels are read is what a check asks for.
  page.on('console', (message) => /GPU stall due to ReadPixels/.test(message.text()) || faults.push(`console: ${message.text()}`));
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  page.on('request', (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url())) faults.push(`request: ${request.url()}`);
  });
  await page.goto(url);
  await page
    .waitForSelector('html[data-ready]', { state: 'attached' })
    .catch(async () => assert.fail(`the page says: ${await page.locator('#message').allTextContents()} ${faults}`));
  return page;
}

/// A browser. Pages are put together without OpenGL, as they are without a GPU: only their own pictures are drawn with it.
function launched() {
  return chromium.launch({
    executablePath: findBrowser(),
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-compositing'],
  });
}

/// Calls a check with a browser and a list of faults, which has to stay empty. Closes all windows after it.
async function checked(browser, check) {
  const faults = [];
  try {
    await check(browser, faults);
    assert.deepStrictEqual(faults, []);
  } finally {
    await Promise.all(browser.contexts().map((context) => context.close()));
  }
}

/// Calls a check in a browser of its own. Prints what is wrong, and makes the program exit with 1.
async function inBrowser(check) {
  try {
    const browser = await launched();
    try {
      await checked(browser, check);
    } finally {
      await browser.close();
    }
  } catch (error) {
    console.error(error.stack);
    process.exitCode = 1;
  }
}

module.exports = { checked, inBrowser, launched, opened };
