// What the pages answer at once: what fails, where, and how sure that is.
const assert = require('assert');
const { hitsFrom, plain, settled } = require('./support.cjs');

/// The texts of elements, all of which are in a window of this size without scrolling; null for one that is hidden.
async function inWindow(page, ids, [width, height]) {
  await page.setViewportSize({ width, height });
  await settled(page);
  const found = await page.evaluate(
    (list) => list.map((id) => { const e = document.getElementById(id); return e.checkVisibility() ? [e.innerText, e.getBoundingClientRect().bottom] : null; }),
    ids,
  );
  for (const item of found) assert(!item || item[1] <= height, `${item} is below the window`);
  return found.map((item) => item && plain(item[0]));
}

module.exports = {
  // The verdict, and how sure it is; nothing of it where nothing is judged.
  async isSure(page, verdict, ...words) {
    const [badge, sure] = await inWindow(page, ['verdict', 'sure'], [1280, 800]);
    assert(badge.endsWith(verdict), badge);
    if (words[0] === 'nothing') assert.strictEqual(sure, null);
    else assert(sure.startsWith('How sure: ') && words.every((word) => sure.includes(word)), sure);
  },

  // The triangles of a group have the bands of its limits: greens where it passes, other colours where it fails; a
  // group that is chosen has its limits beside the bar.
  async bandsByGroup(page, passing, failing, limit) {
    assert.strictEqual(await page.inputValue('#mode'), 'tolerance');
    assert.match(await page.innerText('#legend'), /limits\s+of each group/);
    assert.match(await page.innerText('#legend'), /upper/);
    assert(await page.isHidden('.slider:has(#range)'), 'the range changes nothing');
    if (await page.isVisible('#ghost')) await page.uncheck('#ghost');
    const hits = await hitsFrom(page, 'front', 11);
    const counts = await page.evaluate((list) => {
      const canvas = document.getElementById('canvas');
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [canvas.width, canvas.height];
      const context = copy.getContext('2d');
      context.drawImage(canvas, 0, 0);
      const pixels = canvas.width / canvas.clientWidth;
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      const { names } = window.sdmPage.data.surface.model;
      const counts = {};
      for (const { x, y, triangle } of list) {
        const group = names[0].names[names[0].ofTriangle[triangle] - 1] ?? 'none';
        const [r, g] = data.subarray(4 * (Math.round(y * pixels) * copy.width + Math.round(x * pixels)));
        (counts[group] ??= [0, 0])[g >= r ? 0 : 1] += 1;
      }
      return counts;
    }, hits);
    const kBorder = 0.05; // of the points: between two groups
    for (const [group, bad] of [[passing, 1], [failing, 0]]) {
      const [a, b] = [counts[group][bad], counts[group][1 - bad]];
      assert(b > 20 && a <= kBorder * b, `${group}: ${counts[group]} pixels are green and not green`);
    }
    await page.click(`#groups-table button:text-is("${failing}")`);
    await settled(page);
    assert((await page.$$eval('#legend .of-limit', (list) => list.map((l) => l.textContent))).includes(limit), await page.innerText('#legend'));
    await page.selectOption('#mode', 'viridis');
    assert.ok(!(await page.innerText('#legend')).includes('group'));
  },

  // A group that is chosen, or all, has this limit beside the bar.
  async legendOfGroup(page, group, limit) {
    if (group !== 'all') await page.click(`#groups-table button:text-is("${group}")`);
    await settled(page);
    const limits = await page.$$eval('#legend .of-limit', (list) => list.map((l) => l.textContent));
    assert(limits.includes(limit), await page.innerText('#legend'));
    assert((await page.getAttribute('#legend', 'aria-label')).startsWith('Colour scale from '));
  },

  async opensIn(page, mode) {
    assert.strictEqual(await page.inputValue('#mode'), mode);
  },

  // When the page says that it is ready, the part is drawn, and no message is before it.
  async isReadyWithItsPicture(page) {
    const other = await page.context().newPage();
    await other.addInitScript(() => {
      new MutationObserver(() => {
        const canvas = document.getElementById('canvas');
        if (!('ready' in document.documentElement.dataset) || !canvas || 'opaque' in window) return;
        const copy = document.createElement('canvas');
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const context = copy.getContext('2d');
        context.drawImage(canvas, 0, 0);
        window.opaque = context.getImageData(0, 0, copy.width, copy.height).data.filter((x, i) => i % 4 === 3 && x > 250).length;
        window.message = document.getElementById('message');
      }).observe(document, { attributes: true, subtree: true });
    });
    await other.goto(page.url());
    await other.waitForFunction(() => 'opaque' in window);
    const [opaque, hasMessage] = await other.evaluate(() => [window.opaque, window.message !== null]);
    assert(opaque > 1000, `${opaque} pixels are drawn`);
    assert(!hasMessage);
  },

  // The label of the worst place is beside the legend, also in a narrow window, and differs from any colour behind it.
  async markBesideLegend(page) {
    await page.setViewportSize({ width: 420, height: 800 });
    await settled(page);
    const [label, tick, halo] = await page.evaluate(() => [
      document.querySelector('.callout').getBoundingClientRect().right,
      Math.min(...[...document.querySelectorAll('#legend .tick')].map((t) => t.getBoundingClientRect().left)),
      getComputedStyle(document.querySelector('#leaders .halo')).stroke !== getComputedStyle(document.querySelector('#leaders line:not(.halo)')).stroke,
    ]);
    assert(label <= tick, `a label to ${label}, the legend from ${tick}`);
    assert(halo);
  },

  // The verdict on a sequence in the header of its player, in words that lead to its worst frame.
  async judgesFrames(page, verdict, words, worst) {
    const [badge, judged] = await inWindow(page, ['verdict', 'judged'], [1280, 800]);
    if (verdict === 'nothing') return assert.deepStrictEqual([badge, judged], [null, null]);
    assert(badge.endsWith(verdict), badge);
    assert(judged.includes(words), judged);
    assert((await page.title()).startsWith(`${verdict}: `));
    await page.evaluate(() => window.sdmPlayer.show(3));
    await page.click('#to-worst-frame');
    assert.strictEqual(await page.evaluate(() => window.sdmPlayer.shown), Number(worst));
  },

  // Titles of the charts of a player; without penetration there is none of its depth.
  async charts(page, ...titles) {
    const found = await page.$$eval('.chart h3', (list) => list.map((h) => h.firstChild.textContent.trim()));
    assert.deepStrictEqual(found, titles);
  },

  // The numbers beside the bar of the legend are apart, also where the bar is short; its title is one line.
  async spacesLegend(page) {
    for (const [width, height] of [[1280, 800], [420, 800], [360, 480]]) {
      await page.setViewportSize({ width, height });
      await settled(page);
      const [tops, lines] = await page.evaluate(() => {
        const title = document.createRange();
        title.selectNodeContents(document.querySelector('#legend .unit'));
        return [[...document.querySelectorAll('#legend .tick')].map((t) => t.getBoundingClientRect().toJSON()), title.getClientRects().length];
      });
      tops.sort((a, b) => a.top - b.top);
      assert(tops.length >= 2, 'both ends are named');
      tops.slice(1).forEach((box, i) => assert(box.top - tops[i].top > 0.7 * box.height, `${width}: numbers at ${tops[i].top} and ${box.top}`));
      assert.strictEqual(lines, 1, `the title has ${lines} lines at ${width}`);
    }
  },

  // The part and the reference are named so, and no word of the trade is left alone.
  async speaksPlainly(page) {
    const words = await page.evaluate(() => [...document.querySelectorAll('header, main')].map((e) => e.innerText).join('\n'));
    for (const bad of [/\bO[12]\b/, /\bcertified\b/, /(?<!\()\btexels?\b/i, /(?<!\()\bHausdorff\b/, /\bViridis\b/i])
      assert(!bad.test(words), `${bad} in: ${words.match(new RegExp(`.{0,60}${bad.source}.{0,30}`, bad.flags))?.[0]}`);
  },

  // A part and itself: the least of all points, and the places that are nearest to others, the nearest first.
  async listsNearest(page, separation) {
    assert.strictEqual(await page.textContent('#worst-title'), 'Smallest distances');
    const listed = (await page.$$eval('#worst-table tbody button', (list) => list.map((b) => b.textContent))).map((t) => parseFloat(plain(t)));
    assert(listed.length > 1);
    listed.forEach((d, i) => assert(d >= Number(separation) * (1 - 1e-3) && (i === 0 || d >= listed[i - 1]), `${listed}`));
    const row = await page.$$eval('#numbers-table tbody tr', (rows) => rows.map((r) => r.innerText).find((t) => t.startsWith('Smallest')));
    assert(Math.abs(parseFloat(plain(row).split('\t')[1]) / Number(separation) - 1) < 1e-2 && row.includes('exact'), row);
  },
};
