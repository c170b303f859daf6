// Checks a report.html or player.html in headless Chromium: node check_page.cjs CHECK PAGE [ARGUMENT...]. Packages are found from the
// current folder. Prints what is wrong and exits with 1. Tests run these checks by serve_checks.cjs.
const assert = require('assert');
const { readFileSync } = require('fs');
const { fileURLToPath, pathToFileURL } = require('url');
const { inBrowser, opened } = require('./checks/browser.cjs');
const { animationPage, decodingPage } = require('./checks/model_pages.cjs');
const { pictureOf, plain, settled } = require('./checks/support.cjs');

const checks = {
  ...require('./checks/values.cjs'),
  ...require('./checks/colours.cjs'),
  ...require('./checks/text.cjs'),
  ...require('./checks/reading.cjs'),
  ...require('./checks/section.cjs'),
  ...require('./checks/judging.cjs'),
  ...require('./checks/answers.cjs'),
  ...require('./checks/baked.cjs'),

  // A saved page opens with the callouts, the section, the colours and the view that it was saved with, and can be
  // saved again; the file is a page like any other.
  async saves(page, saved) {
    await page.click('#worst-table tbody tr:first-child button');
    await page.selectOption('#section', '1');
    await page.fill('#section-at', '700');
    await page.selectOption('#mode', 'viridis');
    await page.keyboard.press('Escape');
    const shown = (of) =>
      of.evaluate(() => ({
        callouts: [...document.querySelectorAll('#callout-list li')].map((item) => item.textContent),
        section: ['section', 'section-at', 'mode'].map((id) => document.getElementById(id).value),
        fields: document.getElementById('fields').innerText,
        verdict: document.getElementById('verdict').textContent,
        inside: window.sdmPage.inspect(300, 200),
        rest: JSON.parse(window.sdmPage.text().match(/id="saved">(.*?)<\/script>/)[1]),
      }));
    const before = await shown(page);
    assert.strictEqual(before.callouts.length, 1);
    assert.deepStrictEqual(before.section, ['1', '700', 'viridis']);
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-page')]);
    assert.strictEqual(download.suggestedFilename(), 'report.html');
    await download.saveAs(saved);
    const original = readFileSync(fileURLToPath(page.url()), 'utf8');
    const again = await page.context().browser().newPage({ viewport: page.viewportSize() });
    await again.goto(pathToFileURL(saved).href);
    await again.waitForSelector('html[data-ready]');
    const after = await shown(again);
    // The position of a camera is computed from its angles again.
    const rounded = (value) => JSON.parse(JSON.stringify(value, (_, x) => (typeof x === 'number' ? Number(x.toFixed(6)) : x)));
    assert.deepStrictEqual(rounded(after), rounded(before));
    await again.click('#reset');
    assert.strictEqual(await again.inputValue('#section'), '');
    const text = readFileSync(saved, 'utf8');
    assert.ok(text.length - original.length < 2000, 'only settings were added');
    assert.strictEqual((await again.evaluate(() => window.sdmPage.text())).match(/id="saved"/g).length, 1);
  },

  async callouts(page) {
    const canvas = await page.locator('#canvas').boundingBox();
    const at = await page.evaluate(() => {
      const { clientWidth, clientHeight } = document.getElementById('canvas');
      for (let y = clientHeight / 2; y < clientHeight; y += 3)
        for (let x = 10; x < clientWidth; x += 7) {
          const hit = window.sdmPage.inspect(x, y);
          if (hit && window.sdmPage.inspect(x + 6, y + 6)) return { x: x + 3, y: y + 3 };
        }
    });
    await page.mouse.click(canvas.x + at.x, canvas.y + at.y);
    const distance = await page.evaluate(() => window.sdmPage.inspect(...window.pointer).distance);
    const label = () => page.textContent('.callout >> nth=0');
    const text = await label();
    const shown = Number(plain(text).split(' ')[1]);
    assert(Math.abs(shown - distance) <= 1e-3 * Math.abs(distance), `${text} for ${distance}`);
    const place = () => page.getAttribute('.callout >> nth=0', 'style');
    const before = await place();
    // Dragging turns the part: the callout moves with it and adds no other.
    await page.mouse.move(canvas.x + 200, canvas.y + 100);
    await page.mouse.down();
    await page.mouse.move(canvas.x + 260, canvas.y + 130, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((old) => document.querySelector('.callout').getAttribute('style') !== old, before);
    assert.strictEqual(await label(), text);
    assert.strictEqual(await page.locator('.callout').count(), 1);
    // The largest distances are places to look at.
    await page.click('#worst-table tbody tr:first-child button');
    assert.strictEqual(await page.locator('.callout').count(), 2);
    assert.ok((await page.textContent('.callout >> nth=1')).includes(await page.textContent('#worst-table tbody button >> nth=0')));
    // By the keyboard: the point in the middle, which is now the largest distance.
    await page.focus('#canvas');
    await page.keyboard.press('Enter');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('+');
    assert.strictEqual(await page.locator('#callout-list li').count(), 3);
    await page.click('#callout-list li >> nth=0 >> .remove');
    assert.strictEqual(await page.locator('.callout').count(), 2);
    assert.notStrictEqual(await label(), text);
  },

  // Every control and picture has a name for screen readers, and headings are in order.
  async names(page) {
    const session = await page.context().newCDPSession(page);
    const { nodes } = await session.send('Accessibility.getFullAXTree');
    const roles = new Set(['button', 'slider', 'spinbutton', 'textbox', 'combobox', 'checkbox', 'link', 'image', 'img', 'application', 'table', 'region', 'DisclosureTriangle']);
    const named = nodes.filter((node) => !node.ignored && roles.has(node.role?.value));
    assert(named.length > 20, 'controls were found');
    for (const node of named) assert(node.name?.value, `a ${node.role.value} without a name: ${JSON.stringify(node.properties)}`);
    const levels = await page.$$eval('h1, h2, h3', (list) => list.map((h) => Number(h.tagName[1])));
    levels.forEach((level, i) => assert(i === 0 ? level === 1 : level <= levels[i - 1] + 1, `headings ${levels}`));
    assert.strictEqual(await page.getAttribute('html', 'lang'), 'en');
  },

  // A part that is judged opens with its worst place in front, with a callout, and all of the part beside the legend.
  async opens(page, error = '0.02') {
    await page.waitForTimeout(400); // callouts behind the part fade
    const [callout, ...more] = await page.evaluate(() =>
      [...document.querySelectorAll('.callout')].map((label) => ({ text: label.textContent, hidden: label.classList.contains('behind') })),
    );
    assert(callout && more.length === 0, 'there is not one callout');
    assert(!callout.hidden, 'the worst place is behind the part');
    const { hits, width, height, worst, under } = await page.evaluate(() => {
      const { clientWidth: width, clientHeight: height } = document.getElementById('canvas');
      const dot = document.querySelector('#leaders circle');
      const worst = window.sdmPage.first.distance;
      const under = window.sdmPage.inspect(Number(dot.getAttribute('cx')), Number(dot.getAttribute('cy')));
      const hits = [];
      for (let x = 1; x < width; x += 6) for (let y = 1; y < height; y += 6) if (window.sdmPage.inspect(x, y)) hits.push([x, y]);
      return { hits, width, height, worst, under };
    });
    const stated = Number(plain(callout.text).split(' ')[1]);
    assert(Math.abs(stated - worst) < 0.01 * Math.abs(worst), `${callout.text} for ${worst}`);
    assert(Math.abs(under.distance - worst) < Number(error) * Math.abs(worst), `${under.distance} is shown, not ${worst}`);
    const [x, y] = [0, 1].map((k) => hits.map((hit) => hit[k]));
    const [left, right, top, bottom] = [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)];
    assert(left > 5 && top > 5 && bottom < height - 5 && right < width - 60, `${[left, right, top, bottom]} of ${width} × ${height}`);
    assert((bottom - top) / height > 0.6 || (right - left) / width > 0.5, `small: ${[left, right, top, bottom]} of ${width} × ${height}`);
  },

  async prints(page) {
    const pdf = (await page.pdf({ preferCSSPageSize: true })).toString('latin1');
    const pages = pdf.match(/\/Type\s*\/Page\b(?!s)/g).length;
    assert.strictEqual(pages, 2, `${pages} pages`);
  },

  // The torus at rest, its distances |z − height| of a plane that sinks by `speed` a frame; all ways to another frame.
  async plays(page, height, speed, last) {
    const shown = () => page.evaluate(() => window.sdmPlayer.shown);
    const frame = async (number) => {
      await page.evaluate((n) => window.sdmPlayer.show(n), number);
      return page.evaluate(() => ({
        distances: [window.sdmPlayer.distances(0), window.sdmPlayer.distances(1)],
        positions: [window.sdmPlayer.positions(0), window.sdmPlayer.positions(1)],
        text: document.getElementById('frame').textContent,
        cursor: document.querySelector('.cursor').getAttribute('x1'),
      }));
    };
    const cursors = [];
    for (const number of [0, 3, Number(last)]) {
      const { distances, positions, text, cursor } = await frame(number);
      assert.strictEqual(text, `frame ${number} (0 to ${last})`);
      cursors.push(cursor);
      const plane = Number(height) - number * Number(speed);
      assert(distances[0].length > 500);
      distances[0].forEach((d, i) => {
        const exact = positions[0][3 * i + 2] - plane;
        assert(Math.abs(d - exact) < 2e-3, `${d} at ${exact} in frame ${number}`);
      });
      assert(distances[1].length > 4, 'a coarse body has more vertices of its own');
      positions[1].filter((_, i) => i % 3 === 2).forEach((z) => assert(Math.abs(z - plane) < 1e-3));
    }
    assert.strictEqual(new Set(cursors).size, 3, 'the cursor follows the frame');

    const picture = () => pictureOf(page);
    const settle = () => settled(page);
    await frame(0);
    await settle();
    const first = await picture();
    await page.focus('#canvas');
    await page.keyboard.press('ArrowRight');
    assert.strictEqual(await shown(), 1);
    await page.focus('#time');
    await page.keyboard.press('End');
    assert.strictEqual(await shown(), Number(last));
    await settle();
    assert(!(await picture()).equals(first), 'another frame is another picture');
    const chart = await page.locator('.chart > svg').first().boundingBox();
    await page.mouse.click(chart.x + chart.width * 0.5, chart.y + chart.height / 2);
    const middle = await shown();
    assert(middle > 0 && middle < Number(last), 'the chart leads to its frame');
    await page.click('#play');
    await page.waitForFunction((old) => window.sdmPlayer.shown !== old, middle);
    await page.click('#play');
    assert.strictEqual(await page.textContent('#play'), 'Play');
    // Colours and bodies.
    await frame(0);
    await settle();
    for (const [select, value] of [['#mode', 'paper2006'], ['#style1', 'hidden'], ['#style0', 'ghost']]) {
      const before = await picture();
      await page.selectOption(select, value);
      await settle();
      assert(!(await picture()).equals(before), `${select} changes the picture`);
    }
    const session = await page.context().newCDPSession(page);
    const { nodes } = await session.send('Accessibility.getFullAXTree');
    for (const node of nodes)
      if (!node.ignored && ['button', 'slider', 'spinbutton', 'textbox', 'combobox', 'image', 'application'].includes(node.role?.value))
        assert(node.name?.value, `a ${node.role.value} without a name`);
  },

  // A model of two bodies, of which the second sinks from `height` by `speed` a frame: three.js plays it.
  async animates(page, height, speed, last) {
    const pictures = [];
    for (const frame of [0, 2, 2.5, Number(last)]) {
      const { sizes, z, colors } = await page.evaluate((f) => window.animation.show(f / 30), frame);
      assert.deepStrictEqual(sizes.length, 2);
      z[1].forEach((x) => assert(Math.abs(x - (Number(height) - Number(speed) * frame)) < 1e-4, `${x} in frame ${frame}`));
      assert(colors[0].every((c) => c >= -1e-3 && c <= 1.001), 'colours are from 0 to 1');
      pictures.push(await page.locator('#canvas').screenshot());
    }
    pictures.forEach((picture, i) => pictures.slice(i + 1).forEach((other) => assert(!picture.equals(other), 'frames differ')));
  },
};

/// Runs a check of a page in a window of a browser.
async function run(browser, faults, check, file, ...rest) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
  // Those that a model is shown by are written to the file that the last argument names.
  const made = { animates: animationPage, decodes: decodingPage }[check];
  const page = await opened(context, pathToFileURL(made ? made(file, rest.pop()) : file).href, faults);
  await page.evaluate(() =>
    document.getElementById('canvas').addEventListener('pointermove', (event) => {
      window.pointer = [event.offsetX, event.offsetY];
    }),
  );
  await checks[check](page, ...rest);
}

module.exports = { run };
if (require.main === module) void inBrowser((browser, faults) => run(browser, faults, ...process.argv.slice(2)));
