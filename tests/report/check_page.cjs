// Checks a report.html or player.html in headless Chromium: node check_page.cjs CHECK PAGE [ARGUMENT...]. Packages are found from the
// current folder. Prints what is wrong and exits with 1.
const assert = require('assert');
const { existsSync, readFileSync, writeFileSync } = require('fs');
const { createRequire } = require('module');
const { delimiter, join } = require('path');
const { pathToFileURL } = require('url');
const { chromium } = createRequire(process.cwd() + '/')('playwright-core');

const [check, file, ...rest] = process.argv.slice(2);

function findBrowser() {
  const folders = process.env.PATH.split(delimiter);
  const found = folders.map((folder) => join(folder, 'chromium')).find(existsSync);
  assert(found, 'chromium is needed for this test (Debian package chromium)');
  return found;
}

const numbers = (path) => {
  const bytes = readFileSync(path);
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
};
const plain = (text) => text.replace(/\u2212/g, '-').replace(/[\u00a0\u202f]/g, ' ');

/// The rows of a points.ply without normals.
function plyRows(path) {
  const bytes = readFileSync(path);
  const begin = bytes.indexOf('end_header\n') + 11;
  const size = 24 + 4 + 4 + 3;
  const count = (bytes.length - begin) / size;
  const at = (i) => {
    const row = begin + i * size;
    return {
      point: [0, 8, 16].map((k) => bytes.readDoubleLE(row + k)),
      distance: bytes.readFloatLE(row + 24),
      face: bytes.readInt32LE(row + 28),
    };
  };
  const first = at(0).point;
  let reach = 0;
  for (let i = 0; i < count; ++i) reach = Math.max(reach, Math.hypot(...at(i).point.map((x, k) => x - first[k])));
  return { count, at, size: reach };
}

// What is under the places of a grid, that many pixels apart, seen from a side.
async function hitsFrom(page, side, pixels) {
  await page.selectOption('#side', side);
  await page.evaluate(() => new Promise(requestAnimationFrame));
  return page.evaluate((step) => {
    const { clientWidth, clientHeight } = document.getElementById('canvas');
    const result = [];
    for (let x = 5; x < clientWidth; x += step)
      for (let y = 5; y < clientHeight; y += step) {
        const hit = window.sdmPage.inspect(x, y);
        if (hit) result.push({ ...hit, x, y });
      }
    return result;
  }, pixels);
}

const checks = {
  // The values at many points of several views are those of the map at the texel there, bit by bit, and the texel is
  // the one at the point: |z − height| changes no faster than the point moves.
  async values(page, exrDistance, exrSite, exrSiteType, resolution, height, bound) {
    const distance = new Float32Array(numbers(exrDistance));
    const site = new Uint32Array(numbers(exrSite));
    const type = new Uint32Array(numbers(exrSiteType));
    let hits = 0;
    for (const side of ['corner', 'front', 'top', 'bottom']) {
      const found = await hitsFrom(page, side, 13);
      for (const hit of found) {
        assert(hit.texel, 'a point without a texel');
        const texel = hit.texel[1] * Number(resolution) + hit.texel[0];
        assert.strictEqual(hit.distance, distance[texel], `texel ${hit.texel}`);
        assert.strictEqual(hit.site >>> 2, site[texel]);
        assert.strictEqual(hit.site & 3, type[texel]);
        const exact = Math.abs(hit.point[2] - Number(height));
        assert(Math.abs(exact - hit.distance) <= Number(bound), `${exact} at ${hit.point}, ${hit.distance} shown`);
      }
      hits += found.length;
      // The same by the mouse: the text is the shortest number that is this float.
      const canvas = await page.locator('#canvas').boundingBox();
      for (const hit of found.filter((_, i) => i % 97 === 0)) {
        await page.mouse.move(canvas.x + hit.x, canvas.y + hit.y);
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
        const there = await page.evaluate(() => window.sdmPage.inspect(...window.pointer));
        if (!there) continue; // the cursor is on whole pixels
        const shown = plain(await page.textContent('#probe-distance')).split(' ')[0];
        assert.strictEqual(Math.fround(Number(shown)), distance[there.texel[1] * Number(resolution) + there.texel[0]]);
        assert.strictEqual(await page.textContent('#probe-texel'), there.texel.join(', '));
      }
    }
    assert(hits > 500, `only ${hits} points were on the part`);
  },

  // The values at many points of several views are those of points.ply, bit by bit, and the point is the one in front.
  async points(page, ply) {
    const rows = plyRows(ply);
    let hits = 0;
    for (const side of ['corner', 'top', 'left']) {
      const found = await hitsFrom(page, side, 17);
      for (const hit of found) {
        const row = rows.at(hit.number);
        assert.strictEqual(hit.distance, row.distance);
        assert.strictEqual(hit.face, row.face);
        row.point.forEach((x, k) => assert(Math.abs(x - hit.point[k]) < 1e-5 * rows.size, `${row.point} at ${hit.point}`));
        const away = Math.hypot(hit.place.x - hit.x, hit.place.y - hit.y);
        assert(away < 17, `a point ${away} pixels from the cursor`);
      }
      hits += found.length;
      // Of the points that cover a place, the nearest one to the camera.
      const all = Array.from({ length: rows.count }, (_, i) => rows.at(i).point);
      const some = found.filter((_, i) => i % 41 === 0);
      const covering = await page.evaluate(
        ([points, places]) => {
          const { view, subject } = window.sdmPage;
          const scene = points.map((p) => p.map((x, k) => (x - subject.centre[k]) / subject.size));
          const from = view.camera.position.toArray();
          const at = scene.map((p) => ({ ...view.place(p), away: Math.hypot(...p.map((x, k) => x - from[k])) }));
          return places.map(({ x, y }) =>
            at.map((p, i) => ({ ...p, i })).filter((p) => Math.hypot(p.x - x, p.y - y) < 0.9).map(({ i, away }) => [i, away]),
          );
        },
        [all, some],
      );
      some.forEach((hit, i) => {
        const mine = covering[i].find(([number]) => number === hit.number);
        for (const [number, away] of covering[i])
          assert(!mine || mine[1] <= away + 1e-3, `point ${number} is in front of ${hit.number}`);
      });
      const canvas = await page.locator('#canvas').boundingBox();
      for (const hit of found.filter((_, i) => i % 97 === 0)) {
        await page.mouse.move(canvas.x + hit.x, canvas.y + hit.y);
        await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
        const there = await page.evaluate(() => window.sdmPage.inspect(...window.pointer));
        if (!there) continue; // the cursor is on whole pixels
        const shown = plain(await page.textContent('#probe-distance')).split(' ')[0];
        assert.strictEqual(Math.fround(Number(shown)), rows.at(there.number).distance);
        assert.strictEqual(plain(await page.textContent('#probe-point')).replace(/ /g, ''), String(there.number));
        assert.ok((await page.textContent('#probe-site')).includes(`face ${rows.at(there.number).face} `));
      }
    }
    assert(hits > 500, `only ${hits} points were on the cloud`);
  },

  // A page of some of the points: they are bounded, each once, with its own values, and the extremes are there.
  async sample(page, ply, most, ...extremes) {
    const rows = plyRows(ply);
    const cloud = await page.evaluate(() => {
      const { number, distance, face } = window.sdmPage.data.cloud;
      return { number: Array.from(number), distance: Array.from(distance), face: Array.from(face) };
    });
    const shown = cloud.number.length;
    assert(shown <= Number(most) && shown < rows.count, `${shown} points`);
    cloud.number.forEach((n, i) => {
      assert(i === 0 || n > cloud.number[i - 1], 'points follow each other as in the file');
      assert.strictEqual(cloud.distance[i], rows.at(n).distance);
      assert.strictEqual(cloud.face[i], rows.at(n).face);
    });
    for (const n of extremes) assert(cloud.number.includes(Number(n)), `the extreme ${n} is missing`);
    // No part of the file is left out.
    const gap = cloud.number.reduce((most, n, i) => Math.max(most, n - (i ? cloud.number[i - 1] : 0)), 0);
    assert(gap < (3 * rows.count) / shown + 1, `${gap} points in a row are missing`);
    let usable = 0;
    for (let i = 0; i < rows.count; ++i) usable += rows.at(i).point.every(Number.isFinite);
    const grouped = (n) => n.toLocaleString('en-US').replace(/,/g, ' ');
    const text = plain(await page.innerText('#shown'));
    assert(text.includes(`${grouped(shown)} of the ${grouped(usable)} points`), text);
  },

  async recolours(page) {
    const picture = () => page.locator('#canvas').screenshot();
    const legend = () => page.innerHTML('#legend');
    const chart = () => page.innerHTML('#histogram-chart svg');
    const setField = async (id, value) => {
      await page.locator(`.slider:has(#${id}) input[type=number]`).fill(value);
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
    const original = readFileSync(file, 'utf8');
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
  // Every number of report.json is in the CSV as it is there, and so are the callouts.
  async csv(page, reportJson) {
    await page.click('#worst-table tbody tr:first-child button');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-numbers')]);
    assert.strictEqual(download.suggestedFilename(), 'numbers.csv');
    const [head, ...lines] = readFileSync(await download.path(), 'utf8').trimEnd().split('\r\n');
    assert.strictEqual(head, 'name,value');
    const rows = new Map(lines.map((line) => [line.slice(0, line.indexOf(',')), line.slice(line.indexOf(',') + 1)]));
    assert.strictEqual(rows.size, lines.length, 'a name occurs twice');
    let count = 0;
    const compare = (value, path) => {
      if (value !== null && typeof value === 'object') {
        if (Array.isArray(value) && value.length > 0 && value.every((x) => x === null || typeof x !== 'object'))
          return compare(value.join(' '), path);
        return Object.entries(value).forEach(([key, x]) => compare(x, path ? `${path}.${key}` : key));
      }
      const quoted = rows.get(path);
      assert.notStrictEqual(quoted, undefined, path);
      const found = quoted.startsWith('"') ? quoted.slice(1, -1).replace(/""/g, '"') : quoted;
      if (typeof value === 'number') assert.strictEqual(Number(found), value, path);
      else assert.strictEqual(found, value === null ? '' : String(value), path);
      ++count;
    };
    const report = JSON.parse(readFileSync(reportJson, 'utf8'));
    compare(report, '');
    assert.ok(count > 60, `${count} values`);
    assert.strictEqual(rows.get('fields.part'), '"4711, ""left"""');
    assert.ok(rows.has('callouts.0.distance'));
    assert.ok((await page.textContent('#fields')).includes('4711, "left"'));
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
    const roles = new Set(['button', 'slider', 'spinbutton', 'combobox', 'checkbox', 'link', 'image', 'img', 'application', 'table', 'region', 'DisclosureTriangle']);
    const named = nodes.filter((node) => !node.ignored && roles.has(node.role?.value));
    assert(named.length > 20, 'controls were found');
    for (const node of named) assert(node.name?.value, `a ${node.role.value} without a name: ${JSON.stringify(node.properties)}`);
    const levels = await page.$$eval('h1, h2, h3', (list) => list.map((h) => Number(h.tagName[1])));
    levels.forEach((level, i) => assert(i === 0 ? level === 1 : level <= levels[i - 1] + 1, `headings ${levels}`));
    assert.strictEqual(await page.getAttribute('html', 'lang'), 'en');
  },

  // A part that fails opens with its worst place in front, with a callout, and all of the part beside the legend.
  async opens(page) {
    await page.waitForTimeout(400); // callouts behind the part fade
    const [callout, ...more] = await page.evaluate(() =>
      [...document.querySelectorAll('.callout')].map((label) => ({ text: label.textContent, hidden: label.classList.contains('behind') })),
    );
    assert(callout && more.length === 0, 'there is not one callout');
    assert(!callout.hidden, 'the worst place is behind the part');
    const { hits, width, height, worst, under } = await page.evaluate(() => {
      const { clientWidth: width, clientHeight: height } = document.getElementById('canvas');
      const dot = document.querySelector('#leaders circle');
      const worst = window.sdmPage.report.places.largest[0].distance;
      const under = window.sdmPage.inspect(Number(dot.getAttribute('cx')), Number(dot.getAttribute('cy')));
      const hits = [];
      for (let x = 1; x < width; x += 6) for (let y = 1; y < height; y += 6) if (window.sdmPage.inspect(x, y)) hits.push([x, y]);
      return { hits, width, height, worst, under };
    });
    const stated = Number(plain(callout.text).split(' ')[1]);
    assert(Math.abs(stated - worst) < 0.01 * Math.abs(worst), `${callout.text} for ${worst}`);
    assert(Math.abs(under.distance - worst) < 0.02 * Math.abs(worst), `${under.distance} is shown, not ${worst}`);
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
      assert.strictEqual(text, `frame ${number} of ${last}`);
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

    const picture = () => page.locator('#canvas').screenshot();
    const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
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
      if (!node.ignored && ['button', 'slider', 'spinbutton', 'combobox', 'image', 'application'].includes(node.role?.value))
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

  // Rows beside the cursor, an id and its text each.
  async probes(page, ...rows) {
    const [hit] = await hitsFrom(page, 'top', 13);
    const canvas = await page.locator('#canvas').boundingBox();
    await page.mouse.move(canvas.x + hit.x, canvas.y + hit.y);
    await page.waitForSelector('#probe-distance');
    for (let i = 0; i < rows.length; i += 2) assert.strictEqual(plain(await page.textContent(`#${rows[i]}`)), rows[i + 1]);
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
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    near(
      await page.evaluate(() => {
        const canvas = document.getElementById('canvas');
        const copy = document.createElement('canvas');
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const context = copy.getContext('2d');
        context.drawImage(canvas, 0, 0);
        const { data } = context.getImageData(0, 0, copy.width, copy.height);
        const pixels = [0, 0]; // warm, cool
        for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 250) ++pixels[data[i] > data[i + 2] ? 0 : 1];
        return pixels[1] / (pixels[0] + pixels[1]);
      }),
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
  },

  // A group that is chosen is alone in colours, also in the saved page, until it is chosen again.
  async highlights(page, saved) {
    const settle = (of) => of.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const greys = (of) =>
      of.evaluate(() => {
        const canvas = document.getElementById('canvas');
        const copy = document.createElement('canvas');
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const context = copy.getContext('2d');
        context.drawImage(canvas, 0, 0);
        const { data } = context.getImageData(0, 0, copy.width, copy.height);
        const pixels = [0, 0]; // coloured, grey
        for (let i = 0; i < data.length; i += 4)
          if (data[i + 3] > 250) ++pixels[Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) < 4 ? 1 : 0];
        return pixels[1] / (pixels[0] + pixels[1]);
      });
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

  // Other limits are judged in the page as by the library: what judge() in include/sdm/tolerance.h says in `cases`.
  async judges(page, cases) {
    const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
    const entry = join(__dirname, '../../report/src/verdict.ts');
    const { outputFiles } = buildSync({ entryPoints: [entry], bundle: true, write: false, format: 'cjs' });
    const built = { exports: {} };
    new Function('module', 'exports', outputFiles[0].text)(built, built.exports);
    for (const { evidence, lower, upper, ...expected } of JSON.parse(readFileSync(cases, 'utf8'))) {
      const found = built.exports.judge(evidence, { lower, upper });
      assert.deepStrictEqual(found, expected, JSON.stringify({ evidence, lower, upper }));
    }
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
    const entry = join(__dirname, '../../report/src/color_scale.ts');
    const { outputFiles } = buildSync({ entryPoints: [entry], bundle: true, write: false, format: 'iife', globalName: 'colorScale' });
    await page.evaluate(outputFiles[0].text.replace('var colorScale', 'window.colorScale'));
    const told = await page.evaluate(() => {
      const rows = (id) =>
        [...document.querySelectorAll(`#${id} tbody tr`)].map((row) => [...row.children].map((cell) => cell.textContent));
      const { data, state } = window.sdmPage;
      const { width, height, chart, distance } = data.surface.map;
      const colors = Array.from(distance, (d, i) =>
        chart[i] === 0 ? null : window.colorScale.colorOf(state.scale, data.page.colors, d).map(Math.round),
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

  // The fraction out of tolerance is one number, in the banner and below the sliders, and by the bins nearly the same.
  async percentages(page, fraction) {
    const percents = (text) => [...plain(text).matchAll(/([\d.]+).%/g)].map((match) => Number(match[1]));
    const [stated] = percents(await page.textContent('#sentence'));
    const [below] = percents(await page.textContent('#what-if'));
    assert.strictEqual(below, stated);
    assert(Math.abs(stated - 100 * fraction) <= 0.0051 * Math.max(1, stated), `${stated} for ${100 * fraction}`);
    const { stated: number, binned } = await page.evaluate(() => window.sdmPage.outside());
    assert.strictEqual(number, Number(fraction));
    assert(Math.abs(binned - fraction) < 0.01, `${binned} by bins for ${fraction}`);
  },

  // Opens, and says these words; any words if none are given.
  async says(page, ...words) {
    const text = plain(await page.innerText('body'));
    for (const word of words) assert(text.includes(word), `no "${word}" in: ${text}`);
  },
};

/// A page that plays a model by three.js's own loader.
function animationPage(model, html) {
  const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
  const program = `
    import * as three from 'three';
    import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
    const canvas = document.getElementById('canvas');
    const renderer = new three.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    renderer.setSize(640, 480);
    const bytes = Uint8Array.from(atob(document.getElementById('model').textContent), (c) => c.charCodeAt(0));
    new GLTFLoader().parse(bytes.buffer, '', (gltf) => {
      const scene = new three.Scene();
      scene.background = new three.Color(0xffffff);
      scene.add(gltf.scene, new three.HemisphereLight(0xffffff, 0x888888, 3));
      const camera = new three.PerspectiveCamera(40, 640 / 480, 0.01, 100);
      camera.position.set(6, -9, 3), camera.up.set(0, 0, 1), camera.lookAt(0, 0, -1.5);
      const mixer = new three.AnimationMixer(gltf.scene);
      mixer.clipAction(gltf.animations[0]).play().clampWhenFinished = true;
      const meshes = [];
      gltf.scene.traverse((o) => o.isMesh && meshes.push(o));
      window.animation = {
        show(time) {
          mixer.setTime(Math.min(time, gltf.animations[0].duration - 1e-6));
          renderer.render(scene, camera);
          const p = new three.Vector3();
          const z = meshes.map((m) => Array.from({ length: m.geometry.attributes.position.count }, (_, i) => m.getVertexPosition(i, p).z));
          const colors = meshes.map((m) => {
            const { color } = m.geometry.attributes;
            const targets = m.geometry.morphAttributes.color ?? [];
            return Array.from(color ? color.array : [], (c, i) => targets.reduce((sum, t, k) => sum + m.morphTargetInfluences[k] * t.array[i], c));
          });
          return { sizes: z.map((a) => a.length), z, colors };
        },
      };
      document.documentElement.dataset.ready = '';
    }, (error) => { throw error; });
  `;
  const { outputFiles } = buildSync({ stdin: { contents: program, resolveDir: process.cwd() }, bundle: true, write: false, format: 'iife' });
  const data = readFileSync(model).toString('base64');
  writeFileSync(html, `<!DOCTYPE html><title>Animation</title><link rel="icon" href="data:,"><canvas id="canvas"></canvas>
    <script type="text/plain" id="model">${data}</script><script>${outputFiles[0].text.replace(/<\/script/g, '<\\/script')}</script>`);
  return html;
}

(async () => {
  const browser = await chromium.launch({
    executablePath: findBrowser(),
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  try {
    const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
    const faults = [];
    page.on('console', (message) => faults.push(`console: ${message.text()}`));
    page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
    const url = pathToFileURL(check === 'animates' ? animationPage(file, rest[3]) : file).href;
    page.on('request', (request) => {
      if (request.url() !== url && !request.url().startsWith('data:')) faults.push(`request: ${request.url()}`);
    });
    await page.goto(url);
    await page
      .waitForSelector('html[data-ready]', { state: 'attached', timeout: 60000 })
      .catch(async () => assert.fail(`the page says: ${await page.textContent('#message')} ${faults}`));
    await page.evaluate(() =>
      document.getElementById('canvas').addEventListener('pointermove', (event) => {
        window.pointer = [event.offsetX, event.offsetY];
      }),
    );
    await checks[check](page, ...rest);
    assert.deepStrictEqual(faults, []);
  } finally {
    await browser.close();
  }
})().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
