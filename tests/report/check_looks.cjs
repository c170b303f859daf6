// Checks how a report.html or player.html looks and moves, in headless Chromium: node check_looks.cjs CHECK PAGE [ARGUMENT...].
// Packages are found from the current folder. Prints what is wrong and exits with 1. Tests run these checks by serve_checks.cjs.
const assert = require('assert');
const { execFileSync } = require('child_process');
const { pathToFileURL } = require('url');
const { inBrowser, opened } = require('./checks/browser.cjs');

const atRest = (page) => page.waitForFunction(() => (window.sdmPage ?? window.sdmPlayer ?? window.sdmBaked).view.atRest);

/// Keeps how each picture is drawn from now on. Where the machine does other things, many may pass between two questions.
const watched = (page) =>
  page.evaluate(() => {
    const { view } = window.sdmPage ?? window.sdmPlayer ?? window.sdmBaked;
    const { drawNow } = view;
    window.pictures = [];
    view.drawNow = function (...args) {
      drawNow.apply(this, args);
      const { triangles, points } = view.renderer.info.render;
      window.pictures.push({ width: view.canvas.width, elements: triangles + points, moving: document.getElementById('view').classList.contains('moving') });
    };
    view.drawNow();
  });

/// In the page: what is wrong with the texts that are seen, as sentences. `least`: the pixels of the smallest font.
function faultsOfTexts(least) {
  const faults = [];
  const numbersOf = (color) => (color.match(/[\d.]+/g) ?? []).map(Number);
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => {
    const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x);
    return (high + 0.05) / (low + 0.05);
  };
  // The colours that may be behind an element: one, or the ends of a gradient.
  const backgrounds = (element, { left, right, top, bottom }) => {
    const over = []; // translucent colours, the nearest first
    for (let e = element; e; e = e.parentElement) {
      const box = e.getBoundingClientRect();
      const [x, y] = [(left + right) / 2, (top + bottom) / 2];
      if (x < box.left || x > box.right || y < box.top || y > box.bottom) continue; // the text is beside it
      const style = getComputedStyle(e);
      const mixed = (base) => over.reduceRight((under, [r, g, b, a]) => [r, g, b].map((c, k) => a * c + (1 - a) * under[k]), base);
      if (style.backgroundImage.includes('gradient')) {
        const colors = style.backgroundImage.match(/rgba?\([^)]*\)/g);
        return colors.map((c) => mixed(numbersOf(c).slice(0, 3)));
      }
      const [r, g, b, a = 1] = numbersOf(style.backgroundColor);
      if (a === 1) return [mixed([r, g, b])];
      if (a > 0) over.push([r, g, b, a]);
    }
    return [over.reduceRight((under, [r, g, b, a]) => [r, g, b].map((c, k) => a * c + (1 - a) * under[k]), [255, 255, 255])];
  };
  const boxes = [];
  const check = (element, text, all) => {
    // Of a list or table that scrolls, what is seen.
    const scrolls = element.closest('.scroll, pre, ol, #callouts')?.getBoundingClientRect();
    const rects = scrolls ? all.filter((r) => r.bottom <= scrolls.bottom + 1 && r.top >= scrolls.top - 1 && r.right <= scrolls.right + 1) : all;
    if (rects.length === 0) return;
    const what = `"${text.trim().slice(0, 40)}"`;
    const style = getComputedStyle(element);
    const svg = element.closest('svg');
    const size = parseFloat(style.fontSize) * (svg ? Math.abs(svg.getScreenCTM().a) : 1);
    if (size < least - 0.1) faults.push(`${what} has ${size.toFixed(1)} pixels`);
    const color = numbersOf(svg ? style.fill : style.color).slice(0, 3);
    for (const background of backgrounds(element, rects[0])) {
      const found = contrast(color, background);
      if (found < 4.5) faults.push(`${what} has a contrast of ${found.toFixed(2)}: ${color} on ${background.map(Math.round)}`);
    }
    for (const r of rects) {
      if (r.left < -0.5 || r.right > innerWidth + 0.5) faults.push(`${what} is out of the page, from ${r.left} to ${r.right}`);
      if (!svg && !element.closest('#view')) boxes.push({ what, element, left: r.left, right: r.right, top: r.top, bottom: r.bottom });
    }
  };
  const seen = (element) => element.checkVisibility({ visibilityProperty: true, opacityProperty: true }) && !element.closest('.hidden, .skip, .behind, noscript, option');
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode;
    if (!node.data.trim() || !seen(node.parentElement)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    check(node.parentElement, node.data, [...range.getClientRects()].filter((r) => r.width > 1));
    if (!node.parentElement.closest('td, th')) continue;
    for (const word of node.data.matchAll(/[^\s\u2212/-]+/g)) {
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      const tops = new Set([...range.getClientRects()].filter((r) => r.width > 0).map((r) => Math.round(r.top)));
      if (tops.size > 1 && word[0].length <= 20) faults.push(`"${word[0]}" is broken in a cell`);
    }
  }
  for (const field of document.querySelectorAll('select, input:not([type=range], [type=checkbox])'))
    if (seen(field)) check(field, field.value, [field.getBoundingClientRect()]);
  boxes.forEach((a, i) =>
    boxes.slice(i + 1).forEach((b) => {
      const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const tall = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (wide > 2 && tall > 4 && !a.element.contains(b.element) && !b.element.contains(a.element)) faults.push(`${a.what} is over ${b.what}`);
    }),
  );
  if (document.scrollingElement.scrollWidth > innerWidth) faults.push(`the page is ${document.scrollingElement.scrollWidth} pixels wide`);
  for (const element of document.querySelectorAll('section, .scroll'))
    if (seen(element) && !element.closest('details') && element.scrollWidth > element.clientWidth + 1)
      faults.push(`${element.id || element.closest('section').id} is ${element.scrollWidth} pixels wide in ${element.clientWidth}`);
  return [...new Set(faults)];
}

const kSizes = [[1440, 900], [1280, 800], [420, 860]];
const kPixelsPerPoint = 96 / 72;

/// The words of a PDF with their boxes, in CSS pixels, of each page.
function wordsOf(pdf) {
  const text = execFileSync('pdftotext', ['-bbox', pdf, '-'], { encoding: 'utf8' });
  return text.split('<page ').slice(1).map((page) => ({
    height: kPixelsPerPoint * Number(page.match(/height="([\d.]+)"/)[1]),
    words: [...page.matchAll(/<word xMin="([\d.-]+)" yMin="([\d.-]+)" xMax="([\d.-]+)" yMax="([\d.-]+)">(.*?)<\/word>/g)].map(([, ...w]) => ({
      left: kPixelsPerPoint * w[0],
      top: kPixelsPerPoint * w[1],
      right: kPixelsPerPoint * w[2],
      bottom: kPixelsPerPoint * w[3],
      text: w[4],
    })),
  }));
}

/// The first page of a PDF as a picture, with `scale` pixels a CSS pixel: the colour at a place.
function pictureOf(pdf, scale) {
  const bytes = execFileSync('pdftoppm', ['-r', String(96 * scale), '-f', '1', '-l', '1', pdf], { maxBuffer: 1 << 28 });
  const [head, width] = bytes.toString('latin1', 0, 40).match(/^P6\s+(\d+)\s+\d+\s+255\s/);
  return (x, y) => {
    const at = head.length + 3 * (Math.round(y * scale) * Number(width) + Math.round(x * scale));
    return [bytes[at], bytes[at + 1], bytes[at + 2]];
  };
}

const ringOf = (x, y, radius) => Array.from({ length: 24 }, (_, i) => [x + radius * Math.cos((i * Math.PI) / 12), y + radius * Math.sin((i * Math.PI) / 12)]);
const meanOf = (colors) => [0, 1, 2].map((k) => colors.reduce((sum, c) => sum + c[k], 0) / colors.length);

const checks = {
  // Every text is large enough, has contrast, is in the page and over no other, at three sizes and in both schemes, folded
  // and unfolded; the same on paper.
  async looks(open) {
    for (const [width, height] of kSizes) {
      const page = await open({ width, height, touch: width < 600 });
      await atRest(page);
      const folds = await page.$$eval('details', (list) => list.map((d) => d.open));
      for (const scheme of ['light', 'dark']) {
        await page.emulateMedia({ colorScheme: scheme }); // colours are all that depends on it
        const found = await page.evaluate(faultsOfTexts, 12);
        await page.evaluate(() => document.querySelectorAll('details').forEach((d) => (d.open = true)));
        found.push(...(await page.evaluate(faultsOfTexts, 12)));
        await page.evaluate((opened) => document.querySelectorAll('details').forEach((d, i) => (d.open = opened[i])), folds);
        assert(found.length === 0, `at ${width} × ${height}, ${scheme}:\n${found.slice(0, 12).join('\n')}`);
      }
      await page.context().close();
    }
    const page = await open({ width: 703 }); // 186 mm
    await atRest(page);
    await page.emulateMedia({ media: 'print' });
    await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
    const found = await page.evaluate(faultsOfTexts, 12);
    assert(found.length === 0, `on paper:\n${found.slice(0, 12).join('\n')}`);
    const shadow = await page.evaluate(() => [...document.querySelectorAll('#legend .tick')].map((t) => getComputedStyle(t).textShadow));
    assert(shadow.every((s) => s === 'none'), 'numbers of the legend are blurred on paper');
  },

  // A player opens on the frame of its worst place, with this in front of all that is solid, in the middle of the picture;
  // curves have units and the names of the files. From there it plays all frames, seen whole.
  async opens(open, frame, ...names) {
    const page = await open({});
    await atRest(page);
    const state = () =>
      page.evaluate(() => {
        const { view, worst, shown } = window.sdmPlayer;
        const { clientWidth, clientHeight } = view.canvas;
        const { x, y } = view.place(view.at(worst));
        const callout = document.querySelector('.callout');
        return { shown, hidden: view.isHidden(view.at(worst)), at: [x / clientWidth, y / clientHeight], label: callout.classList.contains('outside') ? '' : callout.textContent, worst };
      });
    const { shown, hidden, at, label, worst } = await state();
    assert.strictEqual(shown, Number(frame));
    assert(!hidden, 'something is in front of the worst place');
    for (const part of at) assert(part > 0.05 && part < 0.95, `the worst place is at ${at}`);
    const stated = Number(label.replace(/\u2212/g, '-').split(/\s/)[0]);
    assert(Math.abs(stated - worst.distance) < 0.01 * Math.abs(worst.distance) + 1e-9, `${label} for ${worst.distance}`);
    const curves = await page.innerText('#charts');
    for (const name of names) assert(curves.includes(`Distance of ${name}`) && (await page.title()).includes(name), `no ${name} in ${curves}`);
    assert.doesNotMatch(curves, /\bO[12]\b/);
    const ticks = (await page.locator('.chart > svg text').allTextContents()).filter((t) => /\u00a0mm$/.test(t));
    assert(ticks.length >= 4, `${ticks.length} ticks with a unit`);
    await page.click('#reset');
    await page.evaluate(() => window.sdmPlayer.show(0));
    assert.strictEqual((await state()).label, '', 'the mark is of its frame alone');
    await page.click('#to-worst');
    assert.strictEqual((await state()).shown, Number(frame));
  },

  // On a phone: the picture leaves half of the height, one finger scrolls the page, two turn the part, words say so.
  async touches(open) {
    const page = await open({ width: 420, height: 860, touch: true });
    await atRest(page);
    const canvas = await page.locator('#canvas').boundingBox();
    assert(canvas.height <= 430, `the canvas has ${canvas.height} of 860 pixels`);
    const keys = await page.innerText('#keys');
    assert.match(keys, /Two fingers turn.*one finger scrolls/);
    assert.doesNotMatch(keys, /click|[Dd]rag|Move over|arrows/);
    const state = () =>
      page.evaluate(() => {
        const { position, target } = (window.sdmPage ?? window.sdmPlayer ?? window.sdmBaked).view.pose;
        return { pose: [...position, ...target].map((x) => x.toFixed(5)).join(), scroll: scrollY };
      });
    const session = await page.context().newCDPSession(page);
    const before = await state();
    const x = canvas.x + canvas.width / 2;
    const y = canvas.y + canvas.height / 2;
    const touch = (type, points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
    await touch('touchStart', [[x, y]]);
    for (let i = 1; i <= 12; ++i) await touch('touchMove', [[x, y - 12 * i]]);
    await touch('touchEnd', []);
    await page.waitForFunction(() => scrollY > 80);
    await page.waitForTimeout(700); // it goes on for a while
    const scrolled = await state();
    assert.strictEqual(scrolled.pose, before.pose);
    await page.evaluate(() => scrollTo(0, 0));
    await touch('touchStart', [[x - 40, y], [x + 40, y]]);
    for (let i = 1; i <= 6; ++i) await touch('touchMove', [[x - 40 + 8 * i, y + 6 * i], [x + 40 + 8 * i, y + 6 * i]]);
    await touch('touchEnd', []);
    const turned = await state();
    assert.notStrictEqual(turned.pose, before.pose, 'two fingers turn the part');
    assert.strictEqual(turned.scroll, 0);
  },

  // On paper: `pages` pages of which the first is full; the callout of the worst place is where the picture shows it; the
  // words are there, and those after a dash are not.
  async prints(open, pdf, pages, ...words) {
    const page = await open({});
    await atRest(page);
    await page.pdf({ path: pdf, preferCSSPageSize: true });
    const found = wordsOf(pdf);
    assert.strictEqual(found.length, Number(pages));
    const lowest = Math.max(...found[0].words.map((w) => w.bottom));
    assert(found.length === 1 || lowest > 0.8 * found[0].height, `page 1 ends at ${lowest} of ${found[0].height}`);
    const text = found.flatMap((p) => p.words.map((w) => w.text)).join(' ');
    for (const word of words)
      if (word.startsWith('-')) assert(!text.includes(word.slice(1)), `"${word.slice(1)}" is on paper`);
      else assert(text.includes(word), `no "${word}" in: ${text}`);

    // The label is to the right or to the left of the dot, 26 pixels from it and 30 above it.
    const [label] = (await page.locator('.callout').allTextContents()).map((t) => t.split(/\s/));
    const { words: onPage } = found[0];
    const first = onPage.findIndex((w, i) => label.every((part, k) => onPage[i + k]?.text === part));
    assert(first >= 0, `the callout ${label.join(' ')} is not on page 1`);
    const [from, to] = [onPage[first], onPage[first + label.length - 1]];
    const y = (from.top + from.bottom) / 2 + 30;
    const at = pictureOf(pdf, 2);
    const isDot = ([x]) => Math.min(...at(x, y)) > 240 && ringOf(x, y, 4).every(([px, py]) => Math.max(...at(px, py)) < 140);
    const kInset = 8; // of the text in its label
    const candidates = [];
    for (let shift = -3; shift <= 3; shift += 0.5) candidates.push([from.left - kInset - 26 + shift], [to.right + kInset + 26 + shift]);
    const dot = candidates.find(isDot);
    assert(dot, `no dot beside ${JSON.stringify([from, to])}`);
    // The colours around it are those around it on the screen.
    const onPaper = meanOf(ringOf(dot[0], y, 9).map(([px, py]) => at(px, py)));
    const onScreen = meanOf(
      await page.evaluate((ring) => {
        const canvas = document.getElementById('canvas');
        const dotOf = document.querySelector('#leaders circle');
        const [cx, cy] = ['cx', 'cy'].map((name) => Number(dotOf.getAttribute(name)));
        const copy = document.createElement('canvas');
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const context = copy.getContext('2d', { willReadFrequently: true });
        context.drawImage(canvas, 0, 0);
        const scale = canvas.width / canvas.clientWidth;
        return ring.map(([x, y]) => [...context.getImageData(Math.round((cx + x) * scale), Math.round((cy + y) * scale), 1, 1).data].slice(0, 3));
      }, ringOf(0, 0, 9)),
    );
    onPaper.forEach((c, k) => assert(Math.abs(c - onScreen[k]) < 40, `${onPaper} around the callout on paper, ${onScreen} on the screen`));
  },

  // Where pictures take long, those of a drag and of a slider have fewer pixels and fewer elements; what is under the
  // cursor stays. Where they do not, all pictures are fine.
  async drags(open, most) {
    const page = await open({});
    await atRest(page);
    await watched(page);
    const last = () => page.evaluate(() => window.pictures.at(-1));
    const fine = await last();
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
      await page.evaluate(() => (window.pictures = []));
      for (let i = 0; i < 5; ++i) {
        await change(i);
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
      }
      const seen = await page.evaluate(() => window.pictures);
      assert(seen.length > 1, `${seen.length} pictures`);
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
      const place = () => page.evaluate(() => window.sdmPage.inspect(...window.sdmPage.explored.middle()));
      const seen = await move();
      const coarse = seen.find((picture) => picture.moving) ?? seen[0];
      const under = await place();
      assert(coarse.moving && coarse.width <= fine.width / 2, `${coarse.width} pixels of ${fine.width}`);
      assert(coarse.elements > 100 && coarse.elements <= Number(most), `${coarse.elements} of ${fine.elements} are drawn`);
      await atRest(page);
      assert.deepStrictEqual(await last(), fine);
      assert.deepStrictEqual(await place(), under);
      await pace(1);
      for (const picture of await move()) assert.deepStrictEqual(picture, fine);
      await atRest(page);
    }
    assert(fine.elements > Number(most), 'the part is too small for this test');
  },
};

/// Runs a check of a page in windows of a browser.
function run(browser, faults, check, file, ...rest) {
  // The page in a window of its own, when it is ready.
  const open = async ({ width = 1280, height = 800, touch = false }) => {
    const context = await browser.newContext({ viewport: { width, height }, hasTouch: touch, isMobile: touch });
    return opened(context, pathToFileURL(file).href, faults);
  };
  return checks[check](open, ...rest);
}

module.exports = { run };
if (require.main === module) void inBrowser((browser, faults) => run(browser, faults, ...process.argv.slice(2)));
