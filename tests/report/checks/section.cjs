// Sections: cut surfaces, profiles, the field of the position, callouts.
const assert = require('assert');
const { settled } = require('./support.cjs');

/// The colour of the picture at a point in the units of the files.
const colorAt = (page, point) =>
  page.evaluate((p) => {
    const { view, subject } = window.sdmPage;
    const { x, y } = view.place(p.map((c, k) => (c - subject.centre[k]) / subject.size));
    const canvas = document.getElementById('canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const ratio = canvas.width / canvas.clientWidth;
    return Array.from(context.getImageData(Math.round(x * ratio), Math.round(y * ratio), 1, 1).data);
  }, point);

const near = (color, expected) => color[3] > 250 && expected.every((x, k) => Math.abs(color[k] - x) < 22);
const kBoth = [153, 158, 166];
const kPart = [242, 173, 107];
const kReference = [128, 178, 237];

async function cutAt(page, axis, position, side) {
  await page.selectOption('#section', String(axis));
  const field = page.locator('.slider:has(#section-at) .field input');
  await field.fill(String(position));
  await page.selectOption('#side', side);
  await settled(page);
  return field;
}

module.exports = {
  // The torus around z with the radii 1 and 0.4, cut at y = 0: two discs, and nothing between them.
  async cutsTorus(page) {
    const field = await cutAt(page, 1, 0.1, 'front');
    assert.strictEqual(await page.inputValue('#section'), '1');
    const value = Number(await page.inputValue('#section-at'));
    assert(Math.abs(value - 1000 * (0.1 + 1.4) / 2.8) <= 1, `the slider is at ${value}`);
    await field.fill('7');
    assert.strictEqual(await field.getAttribute('aria-invalid'), 'true');
    await field.fill('0');
    await page.selectOption('#side', 'front');
    await settled(page);
    for (const x of [-1, 1]) assert(near(await colorAt(page, [x, 0, 0]), kBoth), `no cut surface at ${x}: ${await colorAt(page, [x, 0, 0])}`);
    for (const x of [-1.2, -0.8, 0.85, 1.15]) assert(near(await colorAt(page, [x, 0, 0.1]), kBoth), `no cut surface at ${x}`);
    assert.match(await page.textContent('#section-words'), /Grey: inside of the part/);
    const hole = await colorAt(page, [0, 0, 0]);
    assert(!near(hole, kBoth), `the hole is filled: ${hole}`);
    // The profile is in the colours of the distances, which are those of the legend.
    const profile = await colorAt(page, [1, 0, 0.4]);
    assert(Math.max(...profile.slice(0, 3)) - Math.min(...profile.slice(0, 3)) > 40, `no profile: ${profile}`);
    // The cut surface has no values; the rest of the part has.
    const { inside, outside } = await page.evaluate(() => {
      const { view, subject } = window.sdmPage;
      const at = (p) => view.place(p.map((c, k) => (c - subject.centre[k]) / subject.size));
      const cap = at([1, 0, 0]);
      view.look('back');
      const skin = at([0, 1.4, 0]);
      const outside = window.sdmPage.inspect(skin.x, skin.y);
      view.look('front');
      return { inside: window.sdmPage.inspect(cap.x, cap.y), outside };
    });
    assert.strictEqual(inside, null);
    assert(outside && outside.distance > 0);
    // Away from the cut, the skin is in front.
    await page.selectOption('#side', 'back');
    await settled(page);
    assert(!near(await colorAt(page, [1, 0, 0]), kBoth), 'the cut surface is seen through the part');
  },

  // Two balls of radius 1 around (0, 0, 0) and (0.5, 0, 0), cut at y = 0: what only one of them fills, and both.
  async cutsBoth(page) {
    await cutAt(page, 1, 0, 'front');
    for (const [x, expected] of [[-0.75, kPart], [0.25, kBoth], [1.25, kReference]]) {
      const found = await colorAt(page, [x, 0, 0.02]);
      assert(near(found, expected), `${found} at ${x}, not ${expected}`);
    }
    const line = await colorAt(page, [0.5, 0, 1]);
    assert(Math.max(...line.slice(0, 3)) < 90, `no profile of the reference: ${line}`);
    assert.match(await page.textContent('#section-words'), /as long as the gap.*Orange: .*blue: .*grey: both/);
    // Only one half of the page's part is there, whichever is chosen.
    await page.click('#section-flip');
    await settled(page);
    assert(!near(await colorAt(page, [0.25, 0, 0.02]), kBoth));
  },

  // An open scan, or a cloud, of a ball around 0: nothing says where the part is not.
  async cutsOpen(page) {
    await cutAt(page, 1, 0, 'front');
    for (const x of [-0.5, 0.1, 0.5]) {
      const found = await colorAt(page, [x, 0, 0.02]);
      for (const fill of [kBoth, kPart, kReference]) assert(!near(found, fill), `${found} at ${x}`);
    }
    assert.match(await page.textContent('#section-words'), /[Dd]ark line: the reference\./);
    assert.doesNotMatch(await page.textContent('#section-words'), /blue|[Gg]rey/);
  },

  // A callout that is cut away is hidden until it is asked for, which removes the section.
  async cutsCallouts(page) {
    await page.click('#worst-table tbody tr:first-child button');
    const visible = () => page.$eval('.callout', (label) => getComputedStyle(label).visibility);
    await settled(page);
    assert.strictEqual(await visible(), 'visible');
    const axis = 0;
    const at = await page.evaluate((k) => window.sdmPage.callouts.all[0].point[k], axis);
    // A new section faces the viewer; on one of its sides the callout is.
    await cutAt(page, axis, at > 0 ? at - 0.2 : at + 0.2, 'corner');
    const first = await visible();
    await page.click('#section-flip');
    await settled(page);
    const second = await visible();
    assert.deepStrictEqual([first, second].sort(), ['hidden', 'visible']);
    if (second === 'visible') await page.click('#section-flip');
    await settled(page);
    assert.strictEqual(await visible(), 'hidden');
    assert.strictEqual(await page.$eval('#leaders circle', (dot) => getComputedStyle(dot).visibility), 'hidden');
    assert.strictEqual(await page.locator('#callout-list li.cut-away').count(), 1);
    await page.click('#callout-list li button >> nth=0');
    await settled(page);
    assert.strictEqual(await page.inputValue('#section'), '');
    assert.strictEqual(await visible(), 'visible');
  },
};
