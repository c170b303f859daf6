// Colours of the part, the legend and the picture of the reference.
const assert = require('assert');
const { writeFileSync } = require('fs');
const { createRequire } = require('module');
const { join } = require('path');
const { pathToFileURL } = require('url');
const { pictureOf, plain, settled, shareOfPixels } = require('./support.cjs');
const { alias } = require('../../../report/rules.cjs');

module.exports = {
  async recolours(page) {
    const picture = () => pictureOf(page);
    const legend = () => page.innerHTML('#legend');
    const chart = () => page.innerHTML('#histogram-chart svg');
    const setField = async (id, value) => {
      await page.locator(`.slider:has(#${id}) .field input`).fill(value);
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    };
    let before = [await picture(), await legend(), await chart()];
    const expectChange = async (what) => {
      const now = [await picture(), await legend(), await chart()];
      now.forEach((x, i) => assert(String(x) !== String(before[i]), `${what} did not change picture ${i}`));
      before = now;
    };
    await page.selectOption('#mode', 'diverging');
    await expectChange('the colormap');
    await setField('range', '0.5');
    await expectChange('the range');
    await setField('tolerance', '2');
    await page.selectOption('#mode', 'tolerance');
    await expectChange('bands');
    await setField('tolerance', '0.1');
    await expectChange('the tolerance');
    assert.match(await page.textContent('#what-if'), /FAIL/);
    await setField('tolerance', '100');
    assert.match(await page.textContent('#what-if'), /PASS/);
    // By the keyboard alone.
    await page.focus('#tolerance');
    const value = await page.inputValue('#tolerance');
    await page.keyboard.press('ArrowLeft');
    assert.notStrictEqual(await page.inputValue('#tolerance'), value);
    // A section shows the inside; the reset takes it away.
    before = [await picture(), '', ''];
    await page.selectOption('#section', '0');
    const cut = await picture();
    assert(!cut.equals(before[0]), 'a section did not change the picture');
    await page.click('#ghost');
    assert(!(await picture()).equals(cut), 'the ghost did not change the picture');
    await page.click('#reset');
    assert.strictEqual(await page.inputValue('#section'), '');
  },

  // The verdict, its reason and the colours shown first are those of the report in the page.
  async shows(page, verdict, colours, lo, hi) {
    assert.strictEqual((await page.textContent('#verdict')).trim().split(' ').slice(1).join(' '), verdict);
    const scale = await page.evaluate(() => window.sdmPage.state.scale);
    assert.deepStrictEqual([scale.mode, scale.lo, scale.hi], [colours, Number(lo), Number(hi)]);
    assert.ok((await page.textContent('#what-if')).includes(verdict));
  },

  // Writes what the page shows, as JSON: the words of its tables, the colour scale, and of each texel of its map the colour.
  async tells(page, out) {
    const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
    const entry = join(__dirname, '../../../report/src/color_scale.ts');
    const { outputFiles } = buildSync({ entryPoints: [entry], bundle: true, alias, write: false, format: 'iife', globalName: 'colorScale' });
    await page.evaluate(outputFiles[0].text.replace('var colorScale', 'window.colorScale'));
    const told = await page.evaluate(() => {
      const rows = (id) =>
        [...document.querySelectorAll(`#${id} tbody tr`)].map((row) => [...row.children].map((cell) => cell.textContent));
      const { data, state } = window.sdmPage;
      const { width, height, chart, distance } = data.surface.map;
      const colors = Array.from(distance, (d, i) =>
        chart[i] === 0 ? null : window.colorScale.colorOf(state.scale, d).map(Math.round),
      );
      const words = ['verdict', 'sentence', 'what-if', 'inputs-table', 'legend'].map((id) => [id, document.getElementById(id).innerText]);
      return {
        ...Object.fromEntries(words),
        numbers: rows('numbers-table'),
        groups: rows('groups-table'),
        worst: rows('worst-table'),
        scale: state.scale,
        map: { width, height, distance: Array.from(distance, (d) => (Number.isNaN(d) ? null : d)), colors },
      };
    });
    writeFileSync(out, JSON.stringify(told));
  },

  // The reference in two colours: the share of the area of the triangles that are covered, and of the pixels in a view
  // that is perpendicular to it. A picture of it is written.
  async covers(page, share, picture) {
    const near = (found, what, error) => assert(Math.abs(found - Number(share)) < error, `${found} ${what}, not ${share}`);
    near(
      await page.evaluate(() => {
        const { position, triangle, covered } = window.sdmPage.data.ghost;
        const corner = (i) => position.subarray(3 * triangle[i], 3 * triangle[i] + 3);
        const areas = [0, 0];
        covered.forEach((c, t) => {
          const [a, b, d] = [0, 1, 2].map((k) => corner(3 * t + k));
          const [u, v] = [b, d].map((p) => p.map((x, k) => x - a[k]));
          areas[c] += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
        });
        return areas[1] / (areas[0] + areas[1]);
      }),
      'of the area',
      0.003,
    );
    await page.selectOption('#side', 'top');
    await page.click('#coverage');
    for (const id of ['#mode', '#range', '#tolerance']) assert(await page.isDisabled(id), `${id} changes nothing`);
    await settled(page);
    near(
      await shareOfPixels(page, (r, g, b) => r <= b), // cool
      'of the pixels',
      0.01,
    );
    const legend = plain(await page.innerText('#legend'));
    assert.match(legend, /covered 5\d(\.\d+)? %/);
    assert.match(legend, /not covered 4\d(\.\d+)? %/);
    assert.match(plain(await page.innerText('#numbers-table')), /Coverage of the reference\s+5\d/);
    if (picture) await page.screenshot({ path: picture });
    await page.click('#reset');
    assert.ok(!(await page.innerText('#legend')).includes('covered'));
    for (const id of ['#mode', '#range', '#tolerance']) assert(await page.isEnabled(id), id);
  },

  // A group that is chosen is alone in colours, also in the saved page, until it is chosen again.
  async highlights(page, saved) {
    const settle = (of) => settled(of);
    const greys = (of) => shareOfPixels(of, (r, g, b) => Math.max(r, g, b) - Math.min(r, g, b) < 4);
    await settle(page);
    assert(await greys(page) < 0.01);
    await page.click('#groups-table tbody tr:first-child button');
    await settle(page);
    const share = await greys(page);
    assert(share > 0.2 && share < 0.8, `${share} of the part is grey`);
    assert.strictEqual(await page.getAttribute('#groups-table button >> nth=0', 'aria-pressed'), 'true');
    assert(await page.evaluate(() => document.activeElement.getAttribute('aria-pressed')), 'the button keeps the focus');
    writeFileSync(saved, await page.evaluate(() => window.sdmPage.text()));
    const again = await page.context().browser().newPage({ viewport: page.viewportSize() });
    await again.goto(pathToFileURL(saved).href);
    await again.waitForSelector('html[data-ready]');
    await settle(again);
    assert(Math.abs((await greys(again)) - share) < 0.01);
    await page.click('#groups-table tbody tr:first-child button');
    await settle(page);
    assert(await greys(page) < 0.01);
  },
};
