// What a person reads: the legend, the histogram, numbers below each other, lists that scroll.
const assert = require('assert');
const { readFileSync } = require('fs');
const { createRequire } = require('module');
const { join } = require('path');
const { hitsFrom, plain, settled } = require('./support.cjs');
const { alias } = require('../../../report/rules.cjs');

/// A source of the page as a module.
function built(source) {
  const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
  const entry = join(__dirname, '../../../report/src', source);
  const { outputFiles } = buildSync({ entryPoints: [entry], bundle: true, alias, write: false, format: 'cjs' });
  const found = { exports: {} };
  new Function('module', 'exports', outputFiles[0].text)(found, found.exports);
  return found.exports;
}

const rgb = (text) => text.match(/[\d.]+/g).slice(0, 3).map(Number);
/// The relative luminance of WCAG.
const luminance = (color) => {
  const [r, g, b] = color.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const contrast = (a, b) => {
  const [dark, light] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (light + 0.05) / (dark + 0.05);
};

/// In a page: the colours of the distances of each scale by a shader, as a row of pixels.
function inShader([shader, scales, tables]) {
  const canvas = Object.assign(document.createElement('canvas'), { width: scales[0].distances.length, height: 1 });
  const gl = canvas.getContext('webgl2');
  const program = gl.createProgram();
  const add = (type, source) => {
    const part = gl.createShader(type);
    gl.shaderSource(part, `#version 300 es\nprecision highp float;\n${source}`);
    gl.compileShader(part);
    gl.attachShader(program, part);
  };
  add(gl.VERTEX_SHADER, 'void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }');
  add(gl.FRAGMENT_SHADER, `uniform float d[${canvas.width}];\nout vec4 color;\n${shader}\nvoid main() { color = vec4(colorOf(d[int(gl_FragCoord.x)]), 1.0); }`);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const colors = (name, list) => gl.uniform3fv(at(name), list.flat().map((x) => x / 255));
  for (const [name, list] of Object.entries(tables)) colors(name, list);
  return scales.map(({ distances, stops, mode, ends }) => {
    colors('stops', stops);
    gl.uniform1i(at('stopCount'), stops.length);
    [mode, ...ends].forEach((x, i) => gl.uniform1f(at(['mode', 'lo', 'hi', 'lower', 'upper', 'accuracy'][i]), x));
    gl.uniform1fv(at('d'), distances);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const pixels = new Uint8Array(4 * canvas.width);
    gl.readPixels(0, 0, canvas.width, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return Array.from(pixels);
  });
}

/// The horizontal place of a distance in the chart, by the labels of its axis.
async function axisOf(page) {
  const marks = await page.$$eval('#histogram-chart .tick-text', (list) => list.map((t) => [t.textContent, Number(t.getAttribute('x'))]));
  const [[a, xa], [b, xb]] = [marks[0], marks[marks.length - 1]].map(([text, x]) => [Number(plain(text)), x]);
  return (d) => xa + ((d - a) / (b - a)) * (xb - xa);
}

module.exports = {
  // The legend names the ends of the range and the limits; its words can be read, do not touch, and no colour of a scale
  // vanishes before the view; in both schemes and in narrow windows.
  async legend(page, lo, hi, ...limits) {
    const rules = await import(alias['sdm-rules']);
    for (const [scheme, width] of [['light', 1440], ['dark', 1280], ['light', 420], ['dark', 420]]) {
      await page.emulateMedia({ colorScheme: scheme });
      await page.setViewportSize({ width, height: 800 });
      await settled(page);
      const { labels, ink, behind, boxes } = await page.evaluate(() => {
        const ticks = [...document.querySelectorAll('#legend .tick')];
        const style = getComputedStyle(document.documentElement);
        const probe = document.createElement('i');
        document.body.append(probe);
        const behind = ['--view-top', '--view-bottom'].map((name) => {
          probe.style.color = style.getPropertyValue(name);
          return getComputedStyle(probe).color;
        });
        probe.remove();
        return {
          labels: ticks.map((t) => [t.textContent, t.classList.contains('of-limit')]),
          ink: ticks.map((t) => getComputedStyle(t).color),
          boxes: ticks.map((t) => t.getBoundingClientRect().toJSON()),
          behind,
        };
      });
      const values = labels.map(([text]) => Number(plain(text)));
      assert.strictEqual(Math.min(...values), Number(lo), `${values}`);
      assert.strictEqual(Math.max(...values), Number(hi), `${values}`);
      assert.deepStrictEqual(labels.filter(([, isLimit]) => isLimit).map(([text]) => Number(plain(text))).sort((a, b) => a - b), limits.map(Number));
      for (const color of ink) for (const view of behind) assert(contrast(rgb(color), rgb(view)) >= 4.5, `${color} on ${view}, ${scheme}`);
      const tops = boxes.map((box) => [box.top, box.bottom]).sort((a, b) => a[0] - b[0]);
      tops.forEach(([top], i) => assert(i === 0 || top >= tops[i - 1][1] - 4, `labels touch at ${width}`));
      for (const map of ['kViridis', 'kDiverging', 'kOpposite', 'kWithin', 'kAbove', 'kBelow'])
        for (const stop of rules[map])
          for (const view of behind.map(rgb)) {
            const away = Math.hypot(...stop.map((x, k) => x - view[k]));
            assert(away > 30, `${map} ${stop} vanishes before ${view}, ${scheme}`);
          }
    }
  },

  // Labels and colours are those of pictures, also in shaders, for the scales in `cases`.
  async scales(page, cases) {
    const { scaleLabels } = built('legend.ts');
    const { colorOf, colormapOf, modeOf, kColorShader } = built('color_scale.ts');
    const { kAbove: above, kBelow: below, kOpposite: opposite, kWithin: within } = await import(alias['sdm-rules']);
    const shown = [];
    for (const { scale, labels, distances, colours } of JSON.parse(readFileSync(cases, 'utf8'))) {
      scale.lower ??= -Infinity; // JSON has null for them
      scale.upper ??= Infinity;
      const found = scaleLabels(scale);
      assert.deepStrictEqual(found.map((l) => l.value), labels.map((l) => l.value), JSON.stringify(scale));
      assert.deepStrictEqual(found.map((l) => [plain(l.text), l.isLimit]), labels.map((l) => [plain(l.text), l.limit]), JSON.stringify(scale));
      distances.forEach((d, i) =>
        colorOf(scale, d).forEach((x, k) => assert(Math.abs(x - colours[i][k]) <= 1, `${d} in ${JSON.stringify(scale)}`)),
      );
      const finite = (x) => Math.min(1e38, Math.max(-1e38, x));
      shown.push({ distances, colours, stops: colormapOf(scale), mode: modeOf(scale), ends: ['lo', 'hi', 'lower', 'upper', 'accuracy'].map((key) => finite(scale[key])) });
    }
    const seen = await page.evaluate(inShader, [kColorShader, shown, { above, below, opposite, within }]);
    seen.forEach((pixels, n) => {
      const { distances, colours, ends, mode } = shown[n];
      distances.forEach((d, i) =>
        colours[i].forEach((x, k) => assert(Math.abs(x - pixels[4 * i + k]) <= 2, `${d} in mode ${mode} of ${ends} is ${pixels.slice(4 * i, 4 * i + 3)} in shaders`)));
    });
  },

  // Both limits are in the chart, where they are on its axis, and what is beyond them is tinted; the logarithm shows a
  // share that is small.
  async histogram(page, lower, upper) {
    const x = await axisOf(page);
    const limits = await page.$$eval('#histogram-chart .limit', (list) => list.map((l) => [Number(l.dataset.limit), Number(l.getAttribute('x1'))]));
    assert.deepStrictEqual(limits.map(([limit]) => limit), [lower, upper].filter((l) => l !== 'none').map(Number));
    for (const [limit, at] of limits) assert(Math.abs(at - x(limit)) < 0.5, `the limit ${limit} is at ${at}, not at ${x(limit)}`);
    const tints = await page.$$eval('#histogram-chart .out', (list) => list.map((r) => [Number(r.getAttribute('x')), Number(r.getAttribute('width'))]));
    assert.strictEqual(tints.length, limits.length);
    for (const [limit, at] of limits)
      assert(tints.some(([left, width]) => Math.abs((limit === Number(lower) ? left + width : left) - at) < 0.5), `${tints} at ${at}`);
    const heights = () =>
      page.$$eval('#histogram-chart .bin', (list) => list.map((b) => [Number(b.getAttribute('x')) + Number(b.getAttribute('width')) / 2, Number(b.getAttribute('height'))]));
    const beyond = (bins) => Math.max(...bins.filter(([at]) => at > x(Number(upper))).map(([, height]) => height));
    const linear = beyond(await heights());
    assert(linear > 0 && linear < 20, `${linear} pixels: the share beyond is not small`);
    await page.check('#logarithmic');
    const logarithmic = beyond(await heights());
    assert(logarithmic > 20 && logarithmic > 4 * linear, `${logarithmic} pixels`);
    assert.match(await page.textContent('#histogram-chart'), /ten times/);
    await page.click('#reset');
    assert.strictEqual(await page.isChecked('#logarithmic'), false);
  },

  // Distances have one number of decimals, below each other, in tables, callouts and beside the cursor alike.
  async decimals(page, decimals, unit) {
    const lengths = await page.$$eval(
      '#numbers-table tbody tr td:first-of-type, #worst-table tbody button, #groups-table tbody td:is(:nth-child(5), :nth-child(6))',
      (list) => list.map((cell) => cell.textContent),
    );
    const numbers = lengths.map(plain).filter((text) => text.endsWith(` ${unit}`));
    assert(numbers.length >= 9, `${numbers}`);
    const decimalsOf = (text) => (text.split(' ')[0].split('.')[1] ?? '').length;
    for (const text of numbers) assert.strictEqual(decimalsOf(text), Number(decimals), text);
    const marks = await page.$$eval('#numbers-table tbody tr td:first-of-type', (list, unit) =>
      list.filter((cell) => cell.textContent.endsWith(unit)).map((cell) => {
        const range = document.createRange();
        const at = cell.firstChild.textContent.indexOf('.');
        range.setStart(cell.firstChild, at), range.setEnd(cell.firstChild, at + 1);
        return range.getBoundingClientRect().left;
      }), unit);
    for (const left of marks) assert(Math.abs(left - marks[0]) < 0.6, `decimal marks at ${marks}`);
    const hits = await hitsFrom(page, 'corner', 37);
    const hit = hits[hits.length >> 1];
    const canvas = await page.locator('#canvas').boundingBox();
    const before = await page.locator('.callout').count();
    await page.mouse.move(canvas.x + hit.x, canvas.y + hit.y);
    await settled(page);
    const hover = await page.textContent('#probe-distance');
    await page.mouse.click(canvas.x + hit.x, canvas.y + hit.y);
    assert.strictEqual(await page.locator('.callout').count(), before + 1);
    const callout = await page.textContent(`.callout >> nth=${before}`);
    assert.strictEqual(callout.slice(callout.indexOf(' ') + 1), hover);
    assert.strictEqual(decimalsOf(plain(hover)), Number(decimals), hover);
    assert.ok(plain(await page.textContent('#probe-position')).endsWith(` ${unit}`));
  },

  // Many callouts scroll in their list, and the page stays as long as it was; so do places.
  async lists(page) {
    const length = () => page.evaluate(() => document.documentElement.scrollHeight);
    for (const [width, height] of [[1280, 800], [420, 800]]) {
      await page.setViewportSize({ width, height });
      await settled(page);
      const before = await length();
      const first = await page.locator('#callout-list li').count();
      const hits = await hitsFrom(page, 'corner', 9);
      await page.evaluate((at) => at.forEach(({ x, y }) => window.sdmPage.explored.addCallout(x, y)), hits.filter((_, i) => i % Math.floor(hits.length / 15) === 0).slice(0, 15));
      assert.strictEqual(await page.locator('#callout-list li').count(), first + 15);
      assert.strictEqual(await length(), before, `the page grew at ${width}`);
      const { inside, shown } = await page.$eval('#callouts', (list) => ({ inside: list.scrollHeight, shown: list.clientHeight }));
      assert(inside > shown, 'the list does not scroll');
    }
    assert(await page.$eval('#worst-table .scroll', (list) => list.clientHeight <= 330));
  },

  // A group that is chosen below is seen: the view is in the window, and shows it.
  async choosesGroups(page) {
    await page.setViewportSize({ width: 1280, height: 800 });
    await page.evaluate(() => document.getElementById('more').scrollIntoView());
    const before = await page.evaluate(() => document.getElementById('canvas').toDataURL());
    await page.click('#groups-table tbody tr:nth-child(2) button');
    await settled(page);
    const { top, bottom } = await page.$eval('#view', (view) => view.getBoundingClientRect().toJSON());
    assert(top >= -1 && bottom <= 801, `the view is from ${top} to ${bottom}`);
    assert.notStrictEqual(await page.evaluate(() => document.getElementById('canvas').toDataURL()), before);
    const coloured = await page.evaluate(() => {
      const { clientWidth: width, clientHeight: height } = document.getElementById('canvas');
      const { model } = window.sdmPage.data.surface;
      const named = model.names.find((n) => n.names.includes('sides'));
      const middle = window.sdmPage.subject.middleOf({ kind: named.kind, group: 'sides' });
      const { x, y } = window.sdmPage.view.place(middle);
      return x > 0 && y > 0 && x < width && y < height && !window.sdmPage.view.isHidden(middle);
    });
    assert(coloured, 'the group is out of sight');
    assert.match(await page.textContent('#table-limits'), /their table/);
  },

  // A long table shows its first rows until all are asked for.
  async caps(page, table, rows) {
    const shown = () => page.$$eval(`#more-tables table`, (tables, name) => {
      const found = tables.find((t) => t.caption.textContent === name);
      return [...found.tBodies[0].rows].filter((row) => row.offsetHeight > 0).length;
    }, table);
    assert(await shown() < 15, `${await shown()} rows`);
    await page.click('.show-all');
    assert.strictEqual(await shown(), Number(rows));
  },
};
