// Opens every page of a site in headless Chromium: node check_pages.cjs FOLDER. Lists what is wrong and exits with 1: errors of
// scripts, anything loaded from outside of the folder or missing there, and text that is wider than the window of a
// desktop or of a phone.
const { existsSync, readdirSync } = require('fs');
const { delimiter, join, relative, resolve } = require('path');
const { pathToFileURL } = require('url');
const { chromium } = require('playwright-core');

const folder = resolve(process.argv[2]);
const pages = readdirSync(folder, { recursive: true })
  .filter((name) => name.endsWith('.html'))
  .map((name) => join(folder, name));

/// What is wider than the window, if the page scrolls sideways.
const overflow = (page) =>
  page.evaluate(() => {
    const { clientWidth, scrollWidth } = document.documentElement;
    if (scrollWidth <= clientWidth) return '';
    const widest = [...document.querySelectorAll('article *')].find((e) => e.getBoundingClientRect().right > clientWidth + 1);
    return `${scrollWidth} of ${clientWidth} pixels wide: ${widest ? widest.outerHTML.slice(0, 100) : ''}`;
  });

async function check(browser, size, colorScheme) {
  const context = await browser.newContext({ viewport: size, colorScheme });
  const page = await context.newPage();
  const faults = [];
  let current = '';
  const add = (text) => faults.push(`${relative(folder, current)} (${size.width} pixels, ${colorScheme}): ${text}`);
  const inside = pathToFileURL(folder).href + '/';
  page.on('console', (message) => message.type() === 'error' && add(message.text()));
  page.on('pageerror', (error) => add(error.stack));
  page.on('requestfailed', (request) => add(`not loaded: ${request.url()}`));
  page.on('request', (request) => {
    const url = request.url();
    if (!url.startsWith(inside) && !/^(data|blob):/.test(url)) add(`loads ${url}`);
  });
  for (current of pages) {
    await page.goto(pathToFileURL(current).href);
    await page.evaluate(() => window.MathJax?.startup?.promise);
    const wide = await overflow(page);
    if (wide) add(wide);
  }
  await context.close();
  return faults;
}

/// A search finds the pages about a word, each with a line of text.
async function checkSearch(browser) {
  const page = await browser.newPage();
  await page.goto(pathToFileURL(join(folder, 'search.html')).href + '?q=hausdorff');
  const summary = page.locator('#search-results li', { hasText: 'Hausdorff distance' }).locator('.search-summary').first();
  const text = await summary.textContent({ timeout: 30000 }).catch(() => '');
  await page.close();
  return text.length > 20 ? [] : ['search.html: results have no text'];
}

(async () => {
  const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, 'chromium-headless-shell')).find(existsSync);
  if (!executablePath) throw new Error('chromium-headless-shell is needed to check the pages (Debian package of that name)');
  const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader'] });
  try {
    const desktop = await check(browser, { width: 1440, height: 900 }, 'light');
    const phone = await check(browser, { width: 420, height: 900 }, 'dark');
    const faults = [...desktop, ...phone, ...(await checkSearch(browser))];
    if (faults.length) throw new Error(faults.join('\n'));
    console.log(`${pages.length} pages without faults in Chromium`);
  } finally {
    await browser.close();
  }
})().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
