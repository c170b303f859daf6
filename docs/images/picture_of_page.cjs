// Saves what a browser shows of a page that is ready: node picture_of_page.cjs ADDRESS PICTURE WIDTH HEIGHT. Packages are found
// from the current folder.
const { inBrowser, opened } = require('../../tests/report/checks/browser.cjs');

const [address, picture, width, height] = process.argv.slice(2);
inBrowser(async (browser) => {
  const context = await browser.newContext({ viewport: { width: Number(width), height: Number(height) } });
  const page = await opened(context, address, []);
  await page.waitForTimeout(5000); // for what the page draws after it is ready
  await page.screenshot({ path: picture });
});
