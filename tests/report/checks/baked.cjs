// The page of `sdm bake`, and its models in three.js.
const assert = require('assert');
const { readFileSync } = require('fs');
const { numbers, plain, settled } = require('./support.cjs');

/// The pixels of the canvas when the picture is fine: they stay in the page.
async function pixels(page) {
  await settled(page);
  const kept = await page.evaluateHandle(() => {
    const canvas = document.getElementById('canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    const { width, height, data } = context.getImageData(0, 0, copy.width, copy.height);
    return { width, height, data };
  });
  return { page, kept, width: await kept.evaluate(({ width }) => width) };
}

/// The share of the pixels of columns `from` to `to` that both pictures draw, and of these the share that differs by more
/// than `most` levels.
function compared(a, b, from, to, most) {
  return a.page.evaluate(([{ width, height, data: p }, { data: q }, first, end, levels]) => {
    let [both, far] = [0, 0];
    for (let y = 0; y < height; y += 3)
      for (let x = Math.ceil(first); x < end; x += 3) {
        const i = 4 * (y * width + x);
        if (p[i + 3] < 255 || q[i + 3] < 255) continue;
        ++both;
        if ([0, 1, 2].some((k) => Math.abs(p[i + k] - q[i + k]) > levels)) ++far;
      }
    return { both, far: far / Math.max(1, both) };
  }, [a.kept, b.kept, from, to, most]);
}

const slide = (page, value) =>
  page.evaluate((to) => {
    const split = document.getElementById('split');
    split.value = String(to);
    split.dispatchEvent(new Event('input'));
  }, value);
const splitOf = async (page) => Number(await page.inputValue('#split'));

module.exports = {
  // The slider divides the picture between both meshes, which are under one camera and look alike.
  async slides(page, differs) {
    await page.selectOption('#shading', 'colours');
    await slide(page, 1000);
    const low = await pixels(page);
    await slide(page, 0);
    const high = await pixels(page);
    assert((await compared(low, high, 0, low.width, 255)).both > 1000, 'nothing is drawn');
    const { far } = await compared(low, high, 0, low.width, 12);
    assert(far < 0.05, `${far} of the pixels of both have another colour`);
    await page.selectOption('#shading', 'shape');
    const shape = await pixels(page);
    assert((await compared(shape, high, 0, low.width, 12)).far > 0.5, 'the shape has no colours');
    await slide(page, 1000);
    const coarse = await pixels(page);
    if (differs === 'differs') assert((await compared(shape, coarse, 0, low.width, 12)).far > 0.02, 'the coarse shape is as the detailed one');
    await page.selectOption('#shading', 'colours');
    await slide(page, 400);
    const both = await pixels(page);
    const middle = 0.4 * both.width;
    assert.strictEqual((await compared(both, low, 0, middle - 2, 0)).far, 0, 'left of the line is not the coarse mesh');
    assert.strictEqual((await compared(both, high, middle + 2, both.width, 0)).far, 0, 'right of the line is not the detailed mesh');
  },

  // Of a ball of one colour, whose left half is rough and the right one polished metal, both meshes look alike in light. Metal mirrors a
  // bright sky and a darker ground, and so has more different levels, although more of the lamp falls on the right.
  async shines(page) {
    const spread = ({ kept }, first, end) =>
      kept.evaluate(({ width, height, data }, [from, to]) => {
        const levels = [];
        for (let y = 0; y < height; ++y)
          for (let x = Math.ceil(from * width); x < to * width; ++x) if (data[4 * (y * width + x) + 3] === 255) levels.push(data[4 * (y * width + x)]);
        levels.sort((a, b) => a - b);
        return levels[Math.floor(0.97 * levels.length)] - levels[Math.floor(0.03 * levels.length)];
      }, [first, end]);
    const shown = async (shading, share) => {
      await page.selectOption('#shading', shading);
      await slide(page, share);
      return pixels(page);
    };
    const spreads = async (picture) => [await spread(picture, 0, 0.48), await spread(picture, 0.52, 1)];
    for (const share of [1000, 0]) {
      const [a, b] = await spreads(await shown('colours', share));
      assert(a < 12 && b < 12, `${share}: the colour is not the same everywhere, ${a} and ${b}`);
      const [rough, metal] = await spreads(await shown('lit', share));
      assert(metal > 1.2 * rough, `${share}: the spread of the rough half is ${rough}, that of the metal ${metal}`);
    }
    const low = await shown('lit', 1000);
    const { both, far } = await compared(low, await shown('lit', 0), 0, low.width, 40);
    assert(both > 1000 && far < 0.05, `${far} of the pixels of both have another light`);
  },

  // By mouse, by keyboard, and side by side.
  async compares(page) {
    assert.strictEqual(await splitOf(page), 500);
    const line = await page.locator('#divider').boundingBox();
    const view = await page.locator('#view').boundingBox();
    await page.mouse.move(line.x + line.width / 2, line.y + line.height / 3);
    await page.mouse.down();
    await page.mouse.move(view.x + 0.25 * view.width, line.y + 40, { steps: 4 });
    await page.mouse.up();
    assert(Math.abs((await splitOf(page)) - 250) < 3, `dragged to ${await splitOf(page)}`);
    await page.focus('#split');
    await page.keyboard.press('ArrowRight');
    assert(Math.abs((await splitOf(page)) - 251) < 3);
    await page.focus('#canvas');
    for (const [key, value] of [['l', 1000], ['H', 0], ['b', 500]]) {
      await page.keyboard.press(key);
      assert.strictEqual(await splitOf(page), value, key);
    }
    const pose = () => page.evaluate(() => JSON.stringify(window.sdmBaked.view.pose));
    const before = await pose();
    await page.keyboard.press('ArrowLeft');
    assert.notStrictEqual(await pose(), before);
    await page.keyboard.press('Home');
    await page.selectOption('#arrangement', 'beside');
    assert(await page.isDisabled('#split'));
    assert(!(await page.isVisible('#divider')));
    const beside = await pixels(page);
    const middle = Math.floor(beside.width / 2);
    const seen = (from, to) => compared(beside, beside, from, to, 0).then(({ both }) => both);
    const [left, right] = [await seen(0, middle), await seen(middle, beside.width)];
    assert(left > 500 && Math.abs(left - right) < 0.1 * left, `${left} pixels of the coarse mesh, ${right} of the detailed one`);
    await page.selectOption('#arrangement', 'over');
    const plainMesh = await pixels(page);
    await page.check('#edges');
    const edges = await pixels(page);
    assert((await compared(plainMesh, edges, 0, 0.5 * edges.width, 20)).far > 0.01, 'no triangles are drawn');
    assert.strictEqual((await compared(plainMesh, edges, 0.51 * edges.width, edges.width, 0)).far, 0);
  },

  // The numbers are those of report.json, whose path is given; the words say how the detailed mesh is drawn.
  async statesFacts(page, path, drawn) {
    const report = JSON.parse(readFileSync(path, 'utf8'));
    const text = plain(await page.innerText('body'));
    const grouped = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, ' ');
    const all = Object.values(report.texels).reduce((sum, n) => sum + n, 0);
    for (const n of Object.values(report.texels).filter((n) => n > 0)) assert(text.includes(`${grouped(n)} (${n === all ? '100 %' : ''}`), `no ${n} in ${text}`);
    for (const { file } of Object.values(report.textures)) assert(text.includes(file), `no ${file}`);
    for (const note of report.notes) assert(text.includes(plain(note)), note);
    assert(text.includes(grouped(report.low.triangles)) && text.includes(grouped(report.high.triangles)));
    assert(text.includes(drawn), `no "${drawn}" in ${text}`);
    assert.deepStrictEqual(await page.evaluate(() => JSON.parse(document.getElementById('report').textContent)), report);
    const names = await page.evaluate(() => [...document.querySelectorAll('input, select, canvas')].map((e) => e.getAttribute('aria-label') ?? e.labels?.[0]?.textContent ?? ''));
    assert(names.every((name) => name.trim() !== ''), `controls without names: ${JSON.stringify(names)}`);
  },

  // The normals that three.js decodes from a model at texels are those of a file of floats, three for each texel and NaN for
  // none, to `most` degrees.
  async decodes(page, path, most) {
    const expected = new Float32Array(numbers(path));
    const { size, data } = await page.evaluate(() => window.decoded);
    assert.strictEqual(3 * size * size, expected.length);
    let [worst, sum, count] = [0, 0, 0];
    for (let y = 0; y < size; ++y)
      for (let x = 0; x < size; ++x) {
        const [t, p] = [3 * (y * size + x), 4 * ((size - 1 - y) * size + x)]; // rows of the target are from below
        if (data[p + 3] < 1 || Number.isNaN(expected[t])) continue;
        const [a, b] = [[0, 1, 2].map((k) => expected[t + k]), [0, 1, 2].map((k) => 2 * data[p + k] - 1)];
        const across = Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
        const angle = (Math.atan2(across, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * 180) / Math.PI;
        worst = Math.max(worst, angle), (sum += angle), ++count;
      }
    console.log(`${count} texels: at most ${worst.toFixed(3)}, ${(sum / count).toFixed(3)} degrees on average`);
    assert(count > expected.length / 12, `${count} texels are drawn`);
    assert(worst <= Number(most), `a normal is ${worst} degrees off`);
  },
};
