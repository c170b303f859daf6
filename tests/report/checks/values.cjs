// Values in the 3D view are those of the files.
const assert = require('assert');
const { numbers, plain, plyRows, hitsFrom } = require('./support.cjs');

module.exports = {
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
        const shown = plain(await page.textContent('#probe-exact')).split(' ')[0];
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
        const shown = plain(await page.textContent('#probe-exact')).split(' ')[0];
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

  // Rows beside the cursor, an id and its text each.
  async probes(page, ...rows) {
    const [hit] = await hitsFrom(page, 'top', 13);
    const canvas = await page.locator('#canvas').boundingBox();
    await page.mouse.move(canvas.x + hit.x, canvas.y + hit.y);
    await page.waitForSelector('#probe-distance');
    for (let i = 0; i < rows.length; i += 2) assert.strictEqual(plain(await page.textContent(`#${rows[i]}`)), rows[i + 1]);
  },
};
