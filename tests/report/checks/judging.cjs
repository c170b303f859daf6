// What the page says of tolerances: none, those of the report, and those of its reader; and how it opens.
const assert = require('assert');
const { createRequire } = require('module');
const { join } = require('path');
const { pathToFileURL } = require('url');
const { hitsFrom, plain, settled } = require('./support.cjs');
const { alias } = require('../../../report/rules.cjs');

const marks = (page) => page.locator('#histogram-chart .limit, #histogram-chart .out').count();
const whatIf = async (page) => plain(await page.textContent('#what-if'));

module.exports = {
  // Without a tolerance nothing is judged until the reader sets one, and again when it is taken away. The distances are
  // from 1.6 to 2.4; just above, samples alone do not decide.
  async unjudged(page) {
    const field = page.locator('.slider:has(#tolerance) .field input');
    const none = async () => {
      assert.strictEqual(await field.inputValue(), '');
      assert.strictEqual(await marks(page), 0);
      assert.doesNotMatch(await page.innerText('body'), /PASS|FAIL|slider below/);
      assert(await page.isDisabled('#mode option[value=tolerance]'), 'bands without limits');
    };
    await none();
    assert.match(plain(await page.textContent('#histogram-chart')), /Distance from 1\.6\d* to 2\.40\d*\. /);
    for (const [limit, words] of [
      ['2', /^Would be FAIL with ±2\. About [\d.]+ % of the area is out of it\.$/],
      ['100', /^Would be PASS with ±100\. No sample is out of it\.$/],
      ['2,4001', /^Would be NOT DECIDED with ±2\.4001\./],
      ['0,05', /^Would be FAIL with ±0\.05\./],
      ['2.4001', /^Would be NOT DECIDED with ±2\.4001\. No sample is out of it\. .* the command does, with this tolerance\.$/],
    ]) {
      await field.fill(limit);
      assert.match((await whatIf(page)).replace(/with 2/, 'with ±2').replace('with 100', 'with ±100').replace('with 0.05', 'with ±0.05'), words);
      assert.strictEqual(await field.getAttribute('aria-invalid'), 'false');
    }
    // What is no tolerance leaves nothing of the one before.
    for (const typed of ['-1', 'two', '1.000,5', '0.1 mm']) {
      await field.fill('100');
      await field.fill(typed);
      assert.strictEqual(await field.getAttribute('aria-invalid'), 'true', typed);
      assert.match(await whatIf(page), /^Set a tolerance/, typed);
      assert.strictEqual(await marks(page), 0, typed);
    }
    await field.fill('2.4001');
    assert(await marks(page) > 0);
    await page.selectOption('#mode', 'tolerance');
    await field.fill('');
    await none();
    assert.strictEqual(await field.getAttribute('aria-invalid'), 'false');
    await field.fill('2');
    await page.click('#reset');
    await none();
  },

  // Where nothing can be judged, nobody is asked for a tolerance.
  async withoutTolerance(page) {
    for (const id of ['#tolerance', '#tolerance-lower', '#tolerance-upper', '#what-if']) assert.strictEqual(await page.locator(id).count(), 0, id);
    assert.strictEqual(await marks(page), 0);
  },

  // A wall has the limits that were given.
  async wallLimits(page, lower, upper) {
    const value = (id) => page.locator(`.slider:has(#${id}) .field input`).inputValue();
    assert.deepStrictEqual([await value('tolerance-lower'), await value('tolerance-upper')], [lower, upper]);
    assert.strictEqual(await page.locator('#histogram-chart .limit').count(), [lower, upper].filter(Boolean).length);
  },

  // What would be rounded to zero, and is not, has three digits.
  async rounds() {
    const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
    const entry = join(__dirname, '../../../report/src/precision.ts');
    const built = { exports: {} };
    new Function('module', 'exports', buildSync({ entryPoints: [entry], bundle: true, alias, write: false, format: 'cjs' }).outputFiles[0].text)(built, built.exports);
    const report = { extremes: { max: { distance: 0.5 } }, accuracy: 1e-4 };
    const text = (x, sign) => plain(built.exports.distanceText(x, report, sign));
    assert.deepStrictEqual([text(7.123e-7), text(-7.123e-7, true), text(4e-8, true), text(0), text(0.25)], ['7.12e-7', '-7.12e-7', '+4e-8', '0.00000', '0.25000']);
  },

  // A distance without a sign is not less than zero, in between neither.
  async leastOfAll(page) {
    const [, value, kind] = await page.$$eval('#numbers-table tbody tr', (rows) =>
      [...rows].map((row) => [...row.children].map((c) => c.textContent)).find(([label]) => label === 'Smallest'));
    const less = /at most ([\d.]+)/.exec(plain(kind));
    assert(!less || Number(less[1]) <= parseFloat(value), `${value}, ${kind}`);
  },

  // The reset goes back to the view that the page opened with, from which the worst place is seen.
  async resets(page) {
    const pose = () => page.evaluate(() => [...window.sdmPage.view.pose.position, ...window.sdmPage.view.pose.target].map((x) => x.toFixed(4)));
    const opening = await pose();
    await page.selectOption('#side', 'bottom');
    await settled(page);
    assert.notDeepStrictEqual(await pose(), opening);
    await page.click('#reset');
    await settled(page);
    assert.deepStrictEqual(await pose(), opening);
  },

  // In a narrow window callouts are beside the legend, and the verdicts of groups are seen.
  async narrow(page) {
    await page.setViewportSize({ width: 420, height: 860 });
    const hits = await hitsFrom(page, 'corner', 9);
    await page.evaluate((at) => at.forEach(({ x, y }) => window.sdmPage.explored.addCallout(x, y)), hits.filter((_, i) => i % Math.ceil(hits.length / 20) === 0));
    await settled(page);
    const { labels, ticks, verdicts } = await page.evaluate(() => {
      const boxes = (selector) => [...document.querySelectorAll(selector)].map((e) => e.getBoundingClientRect().toJSON());
      return { labels: boxes('.callout'), ticks: boxes('#legend .tick'), verdicts: boxes('#groups-table b') };
    });
    const left = Math.min(...ticks.map((t) => t.left));
    assert(labels.length >= 15 && verdicts.length > 0);
    for (const label of labels) assert(label.right <= left && label.left >= 0, `a callout from ${label.left} to ${label.right}, the legend from ${left}`);
    for (const verdict of verdicts) assert(verdict.right < 410, `a verdict ends at ${verdict.right}`);
  },

  // Without WebGL one sentence says so, and all else is there.
  async withoutWebgl(page) {
    const other = await page.context().browser().newPage({ viewport: page.viewportSize() });
    await other.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null));
    await other.goto(pathToFileURL(new URL(page.url()).pathname).href);
    await other.waitForSelector('#view.failed');
    const message = await other.textContent('#message');
    assert.match(message, /^The part cannot be shown \(this browser has no WebGL 2, or it is switched off\)\. The numbers are complete\.$/);
    await other.waitForFunction(() => document.querySelectorAll('#histogram-chart .bin').length > 5);
    for (const id of ['numbers', 'worst']) assert(await other.locator(`#${id}-table tbody tr`).count() > 0, id);
    assert.strictEqual(await other.locator('#worst-table button').count(), 0);
    assert(!(await other.isVisible('#controls')));
  },
};
