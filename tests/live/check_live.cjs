// Checks live.html in headless Chromium: node check_live.cjs PAGE COMMAND CHECK..., where the command is sdm. All checks share a
// browser, and have a page each. Packages are found from the current folder. Prints what is wrong and exits with 1.
const assert = require('assert');
const { execFileSync } = require('child_process');
const { createServer } = require('http');
const { mkdtempSync, readFileSync, rmSync, writeFileSync } = require('fs');
const { tmpdir } = require('os');
const { join } = require('path');
const { pathToFileURL } = require('url');
const { inBrowser, opened } = require('../report/checks/browser.cjs');
const { plain } = require('../report/checks/support.cjs');
const { areaOf, ball, glbOf, grid, objOf, pngOf, skeletonOf, stlOf } = require('./meshes.cjs');

const [file, command, ...names] = process.argv.slice(2);
const address = `${pathToFileURL(file).href}?map=256`; // small maps: each texel counts
const made = []; // folders
process.on('exit', () => made.forEach((path) => rmSync(path, { recursive: true, force: true })));
const folder = () => made[made.push(mkdtempSync(join(tmpdir(), 'sdm-live-'))) - 1];

const kPatience = Number(process.env.SDM_PATIENCE ?? 120000); // milliseconds, on a machine that does other things

const numbers = (page) => page.evaluate(() => window.sdmLive.numbers);
/// Does something, and waits for the fine map after it.
async function atRest(page, action) {
  const before = await page.getAttribute('html', 'data-rest');
  await action();
  await page.waitForFunction((old) => document.documentElement.dataset.rest !== old, before, { timeout: kPatience });
}
async function open(page, paths, id = '#open-both') {
  await atRest(page, () => page.setInputFiles(id, paths));
}

/// The path of a file that a button saves.
async function saved(page, id, name) {
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: kPatience }), page.click(id)]);
  assert.strictEqual(download.suggestedFilename(), name);
  const path = join(folder(), name);
  await download.saveAs(path);
  return path;
}

/// The bytes of a model that a button saves, of which the Khronos validator says nothing.
async function savedModel(page, id, name) {
  const path = await saved(page, id, name);
  try {
    execFileSync(process.execPath, [join(__dirname, '../io_write/validate_glb.cjs'), path], { cwd: process.env.SDM_VALIDATOR_FOLDER });
  } catch (error) {
    assert.fail(`${error.stdout}${error.stderr}`);
  }
  return readFileSync(path);
}

/// What the command measures of the bodies that the page shows.
function byCommand(meshes, resolution) {
  const out = folder();
  const files = meshes.map((mesh, i) => join(out, `${i}.obj`));
  meshes.forEach((mesh, i) => writeFileSync(files[i], objOf(mesh)));
  execFileSync(command, ['map', ...files, '-o', join(out, 'map'), '--resolution', String(resolution), '--write', 'none'], { stdio: 'pipe' });
  return JSON.parse(readFileSync(join(out, 'map', 'report.json'), 'utf8'));
}

/// `within`: of the largest distance.
async function agreesWithCommand(page, within = 1e-4) {
  const of = await numbers(page);
  const expected = byCommand(await page.evaluate(() => window.sdmLive.meshes), of.atlas.resolution);
  assert.strictEqual(of.sign.method, expected.sign.method);
  // Layouts of other machines may differ by a few texels in a million; those of a body before it deformed differ more.
  assert(Math.abs(of.atlas.texels / expected.atlas.texels - 1) < Math.max(1e-4, 10 * within), `${of.atlas.texels} texels, ${expected.atlas.texels} by the command`);
  const size = Math.max(Math.abs(expected.extremes.min.distance), Math.abs(expected.extremes.max.distance));
  const most = (of.atlas.texels === expected.atlas.texels ? 1e-6 : within) * size;
  const close = (a, b, what) => assert(Math.abs(a - b) <= most, `${what}: ${a}, and ${b} by the command`);
  for (const [key, value] of Object.entries(expected.distance)) if (typeof value === 'number') close(of.distance[key], value, key);
  for (const end of ['min', 'max']) close(of.extremes[end].distance, expected.extremes[end].distance, end);
  close(of.error_bound, expected.error_bound, 'error bound');
  return of;
}

/// The surface that is drawn is the one that was measured, and the areas of its texels are those of its faces.
async function agreesWithPicture(page) {
  const of = await numbers(page);
  const { drawn, meshes } = await page.evaluate(() => ({ drawn: window.sdmLive.drawn, meshes: window.sdmLive.meshes }));
  assert.deepStrictEqual([drawn.triangles, drawn.resolution], [meshes[0].indices.length / 3, of.atlas.resolution]);
  const area = areaOf(meshes[0]);
  assert(Math.abs(drawn.area / area - 1) < 0.02, `the texels have an area of ${drawn.area}, and the faces of ${area}`);
}

/// Makes choices, one at once after the other.
const choose = (page, ...choices) =>
  page.evaluate((list) => {
    for (const [id, value] of list) {
      const select = document.getElementById(id);
      select.value = value;
      select.dispatchEvent(new Event('change'));
    }
  }, choices);
/// Waits until nothing is loaded, moves or is computed.
const isIdle = (page) => page.waitForFunction(() => window.sdmLive.atRest, null, { timeout: kPatience });

const checks = {
  // The numbers of each built-in pair are those of the command, and stand in the table.
  async numbers(page) {
    for (const scene of ['letters', 'figure', 'cloth']) {
      if (scene !== 'letters') await atRest(page, () => page.selectOption('#scene', scene));
      const of = await agreesWithCommand(page);
      const row = plain(await page.textContent('#numbers-table tbody tr:first-child td'));
      assert(Math.abs(parseFloat(row) - of.extremes.max.distance) < 1e-3, row);
      assert((await page.locator('#histogram-chart .bin').count()) > 10);
      assert.strictEqual((await page.textContent('#verdict')).trim(), 'i MEASURED');
    }
  },

  // Moving the reference, by the keyboard and by a handle, changes the numbers as the command says; putting it back restores them.
  async moves(page) {
    const before = await numbers(page);
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowRight'));
    const after = await agreesWithCommand(page);
    assert(after.distance.mean > before.distance.mean, `${before.distance.mean} became ${after.distance.mean}`);
    assert.strictEqual(after.o2.transform, 'the handles');
    await atRest(page, () => page.click('#reset-motion'));
    assert.deepStrictEqual((await numbers(page)).distance, before.distance);

    await page.check('#handles-move', { force: true });
    const box = await page.locator('#canvas').boundingBox();
    const at = await page.evaluate(() => window.sdmLive.handleAt('X'));
    // A handle is found once it has been drawn.
    for (const end = Date.now() + kPatience; (await page.evaluate(() => window.sdmLive.handle)) !== 'X'; ) {
      assert(Date.now() < end, `no handle at ${at.x}, ${at.y}`);
      await page.mouse.move(box.x + at.x + 1, box.y + at.y);
      await page.mouse.move(box.x + at.x, box.y + at.y);
    }
    await page.mouse.down();
    const separation = await page.textContent('#separation');
    await page.mouse.move(box.x + at.x + 30, box.y + at.y + 4, { steps: 6 });
    await page.waitForFunction((old) => document.getElementById('separation').textContent !== old, separation, { timeout: kPatience });
    assert.match(await page.textContent('#rate'), /frames\/s/);
    await atRest(page, () => page.mouse.up());
    await agreesWithCommand(page);
    assert.strictEqual(await page.locator('#callout-list li').count(), 0, 'a handle is not a point of the part');
  },

  // A scene plays with other distances in each frame, and rests as the command measures it.
  async plays(page) {
    const first = await page.textContent('#live-mean');
    await page.click('#play');
    await page.waitForFunction((old) => document.getElementById('live-mean').textContent !== old, first, { timeout: kPatience });
    assert.strictEqual(await page.textContent('#play'), 'Stop');
    // What is of the last rest is not said of what moves.
    assert.match(await page.textContent('#verdict'), /MOVING/);
    assert.match(await page.textContent('#sentence'), /at rest/);
    assert(await page.isDisabled('#save-report'), 'the report would be of another moment');
    // A tolerance is judged at rest.
    const { distance } = (await numbers(page)).extremes.max;
    await page.fill('input[aria-label^="Tolerance"]', String(0.5 * distance));
    await page.waitForTimeout(700);
    assert.match(await page.textContent('#verdict'), /MOVING/);
    assert.strictEqual((await numbers(page)).tolerance, undefined);
    await atRest(page, () => page.click('#play'));
    await agreesWithCommand(page, 1e-2); // which lays the letters out as they are now
    const of = await numbers(page);
    assert(Math.abs(of.tolerance.value - 0.5 * distance) < 1e-9, `${of.tolerance.value}`);
    assert((await page.textContent('#verdict')).includes(of.tolerance.verdict));
    assert(!(await page.isDisabled('#save-report')));
    await agreesWithPicture(page);
    assert.match(await page.textContent('#spoken'), /Distances from .* to .*Separation/);
  },

  // Many changes of both bodies need no more memory than a few: frames of a scene, and 10,000 refits.
  async remains(page) {
    const bytes = () => page.evaluate(() => window.sdmLive.memoryBytes());
    const stays = async (what, change) => {
      await change();
      const before = await bytes();
      await change();
      const after = await bytes();
      assert(after < before + 2 ** 20, `${what}: ${before} bytes became ${after}`); // some pages of fragments; each position kept takes more
    };
    await stays('frames', () => page.evaluate(() => window.sdmLive.measure(60)));
    await page.evaluate(async (mesh) => {
      const { worker } = window.sdmLive;
      const { positions, indices } = mesh;
      const objects = [await worker.surface(positions, indices, { resolution: 64 }), await worker.sites(positions, indices)];
      const pair = await worker.pair(mesh, mesh);
      const map = await objects[0].map(objects[1]);
      window.refits = async (times) => {
        for (let i = 0; i < times; ++i) {
          const moved = Float64Array.from(positions, (x) => (1 + 0.1 * Math.sin(i)) * x);
          const refits = [...objects.map((object) => object.refit(moved)), pair.refit(i % 2, moved)];
          await Promise.all(i % 100 === 0 ? [...refits, map.update(), pair.separation()] : refits);
        }
      };
    }, ball(6, 1));
    await stays('refits', () => page.evaluate(() => window.refits(5000)));
  },

  // On a phone, whose windows have maps of 512², two bodies of 50,000 faces together are within 100 MB: the module and the page.
  async weighs(page) {
    const out = folder();
    const files = [1, 1.05].map((radius) => join(out, `${radius}.obj`));
    [1, 1.05].forEach((radius, i) => writeFileSync(files[i], objOf(ball(80, radius))));
    await atRest(page, () => choose(page, ['resolution', '512']));
    await open(page, files);
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowRight'));
    await isIdle(page);
    const of = await numbers(page);
    assert(of.atlas.resolution === 512 && of.o1.triangles + of.o2.triangles > 50000, JSON.stringify([of.atlas, of.o1.triangles, of.o2.triangles]));
    const session = await page.context().newCDPSession(page);
    await session.send('HeapProfiler.collectGarbage');
    const { usedSize, backingStorageSize } = await session.send('Runtime.getHeapUsage');
    const parts = [await page.evaluate(() => window.sdmLive.memoryBytes()), usedSize, backingStorageSize];
    assert(parts.every((bytes) => bytes > 1e6), `${parts}`);
    assert(parts.reduce((a, b) => a + b) <= 100e6, `${parts} bytes`);
  },

  // A tolerance is judged as the library does.
  async judges(page) {
    const { extremes, error_bound: bound } = await numbers(page);
    const verdict = async (value, expected) => {
      await page.fill('input[aria-label^="Tolerance"]', String(value));
      await page.waitForFunction((word) => document.getElementById('verdict').textContent.includes(word), expected, { timeout: kPatience });
      assert((await page.textContent('#what-if')).includes(expected));
    };
    await verdict(0.9 * extremes.max.distance, 'FAIL');
    await verdict(extremes.max.distance + 2 * bound, 'PASS');
    assert((await page.textContent('#sentence')).startsWith('Every point'));
    for (const typed of ['-1', '']) {
      await verdict(extremes.max.distance + 2 * bound, 'PASS');
      assert.match(await page.textContent('#sure'), /proven/);
      await page.fill('input[aria-label^="Tolerance"]', typed);
      await page.waitForFunction(() => document.getElementById('verdict').textContent.trim() === 'i MEASURED', null, { timeout: kPatience });
      assert.strictEqual(await page.textContent('#sure'), '', typed);
    }
    await page.fill('input[aria-label^="Tolerance"]', '0,05');
    await page.waitForFunction(() => document.getElementById('what-if').textContent.includes('0.05'), null, { timeout: kPatience });
    await page.fill('input[aria-label^="Tolerance"]', '');
    await page.waitForFunction(() => document.getElementById('verdict').textContent.trim() === 'i MEASURED', null, { timeout: kPatience });
    await page.waitForFunction(() => document.getElementById('worst-title').textContent === 'Largest distances', null, { timeout: kPatience });
  },

  // Two files, chosen and dropped; one in place of the other; both swapped.
  async opens(page) {
    const out = folder();
    const [small, large, sheet] = [ball(12, 1), ball(12, 1.5), grid(20)];
    writeFileSync(join(out, 'small.stl'), stlOf(small));
    writeFileSync(join(out, 'large.obj'), objOf(large));
    writeFileSync(join(out, 'sheet.obj'), objOf(sheet));
    await open(page, [join(out, 'small.stl'), join(out, 'large.obj')]);
    const of = await numbers(page);
    assert.deepStrictEqual([of.o1.file, of.o2.file, of.o1.closed], ['small.stl', 'large.obj', true]);
    assert(of.extremes.max.distance < -0.45 && of.extremes.min.distance > -0.55, JSON.stringify(of.extremes));
    assert.match(await page.title(), /small.stl compared with large.obj/);
    await atRest(page, () => page.click('#swap'));
    assert.strictEqual((await numbers(page)).o1.file, 'large.obj');
    await open(page, [join(out, 'sheet.obj')], '#open-part');
    assert.deepStrictEqual([(await numbers(page)).o1.file, (await numbers(page)).o1.closed], ['sheet.obj', false]);
    await atRest(page, () =>
      page.evaluate(
        (texts) => {
          const dataTransfer = new DataTransfer();
          for (const [name, text] of texts) dataTransfer.items.add(new File([text], name));
          document.body.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
        },
        [['a.obj', objOf(small)], ['b.obj', objOf(large)]],
      ),
    );
    assert.deepStrictEqual([(await numbers(page)).o1.file, (await numbers(page)).o2.file], ['a.obj', 'b.obj']);
    await agreesWithCommand(page);
  },

  // A file that cannot be used is one sentence with its name, and the page goes on with what it had.
  async refuses(page) {
    const out = folder();
    const whole = stlOf(ball(12, 1));
    const files = { 'cut.stl': whole.subarray(0, whole.length - 30), 'empty.ply': Buffer.alloc(0), 'notes.txt': Buffer.from('no mesh\n'), 'nan.obj': Buffer.from('v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n') };
    const before = await numbers(page);
    for (const [name, bytes] of Object.entries(files)) {
      writeFileSync(join(out, name), bytes);
      await page.setInputFiles('#open-part', join(out, name));
      await page.waitForFunction((n) => document.querySelector('#status.fault')?.textContent.includes(n), name, { timeout: kPatience });
      const text = await page.textContent('#status');
      assert.match(text, /[.?]$/, text);
      assert(!/\n/.test(text) && text.length < 300, text);
    }
    await page.setInputFiles('#open-both', Object.keys(files).slice(0, 3).map((name) => join(out, name)));
    await page.waitForFunction(() => /one file for each body/.test(document.getElementById('status').textContent));
    await atRest(page, () => page.click('#swap'));
    await atRest(page, () => page.click('#swap'));
    assert.deepStrictEqual((await numbers(page)).distance, before.distance);
  },

  // What takes long can be cancelled: what was there before is there again.
  async cancels(page) {
    const out = folder();
    writeFileSync(join(out, 'a.stl'), stlOf(ball(240, 1)));
    writeFileSync(join(out, 'b.stl'), stlOf(ball(240, 1.1)));
    const before = await numbers(page);
    await page.setInputFiles('#open-both', [join(out, 'a.stl'), join(out, 'b.stl')]);
    await page.waitForSelector('#cancel:not([hidden])', { timeout: kPatience });
    await page.click('#cancel');
    await page.waitForFunction(() => document.getElementById('status').textContent === 'Cancelled.', null, { timeout: kPatience });
    await isIdle(page);
    assert.deepStrictEqual((await numbers(page)).distance, before.distance);
    assert.strictEqual(await page.inputValue('#scene'), 'letters');
    assert.match(await page.title(), /E compared with G/);
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowRight'));
    assert.strictEqual((await agreesWithCommand(page)).o2.transform, 'the handles');
  },

  // Of several choices, made while others are loaded, the last one is shown, with the map that was chosen last.
  async chooses(page) {
    await choose(page, ['scene', 'letters'], ['scene', 'cloth'], ['scene', 'letters'], ['scene', 'figure']);
    await isIdle(page);
    assert.strictEqual((await numbers(page)).o1.file, 'figure');
    assert.strictEqual(await page.inputValue('#scene'), 'figure');
    await agreesWithPicture(page);
    await choose(page, ['scene', 'cloth'], ['resolution', '1024'], ['resolution', '512']);
    assert(await page.isDisabled('#play'), 'a pair that is being loaded cannot play');
    await isIdle(page);
    const of = await agreesWithCommand(page);
    assert.deepStrictEqual([of.o1.file, of.atlas.resolution], ['cloth', 512]);
    await agreesWithPicture(page);
  },

  // A part in another unit is found, and converted by a button.
  async converts(page) {
    const out = folder();
    const files = { 'metres.obj': ball(20, 0.05), 'nominal.obj': ball(24, 49), 'fits.obj': ball(20, 50) };
    for (const [name, mesh] of Object.entries(files)) writeFileSync(join(out, name), objOf(mesh));
    const [metres, nominal, fits] = Object.keys(files).map((name) => join(out, name));
    await open(page, [metres, nominal]);
    await isIdle(page);
    assert.strictEqual(await page.textContent('#status'), 'metres.obj × 1000 has the size of nominal.obj: is it in another unit?');
    assert.strictEqual(await page.textContent('#convert'), 'Scale the part × 1000');
    await atRest(page, () => page.click('#convert'));
    await isIdle(page);
    const converted = await agreesWithCommand(page);
    assert(await page.isHidden('#convert'));
    await open(page, [fits, nominal]);
    await isIdle(page);
    const { distance } = await numbers(page);
    assert(await page.isHidden('#convert'));
    for (const key of ['min', 'max', 'mean']) assert(Math.abs(distance[key] - converted.distance[key]) < 1e-4, key);
    await open(page, [metres, nominal]);
    await isIdle(page);
    await atRest(page, () => page.click('#swap'));
    await isIdle(page);
    assert.strictEqual(await page.textContent('#convert'), 'Scale the part ÷ 1000');
  },

  // Without memory for a fine map there is the coarse one, of what is shown.
  async lacks(page) {
    await atRest(page, () => choose(page, ['resolution', '512']));
    await isIdle(page);
    await page.evaluate(() => {
      const { worker } = window.sdmLive;
      const { surface } = worker;
      worker.surface = (positions, indices, options) => (options.resolution > 256 ? Promise.reject(new Error('Out of memory')) : surface.call(worker, positions, indices, options));
    });
    for (const [id, value] of [['scene', 'cloth'], ['resolution', '2048']]) {
      await choose(page, [id, value]);
      await page.waitForFunction(() => document.querySelector('#status.fault')?.textContent === 'Out of memory.', null, { timeout: kPatience });
      await isIdle(page);
      const of = await agreesWithCommand(page);
      assert.deepStrictEqual([of.o1.file, of.atlas.resolution], ['cloth', 256]);
      assert.deepStrictEqual([await page.inputValue('#scene'), await page.inputValue('#resolution')], ['cloth', '256']);
      await agreesWithPicture(page);
    }
  },

  // A worker that has ended by a fault is replaced, with what is shown where it was.
  async recovers(page) {
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowRight'));
    const before = await numbers(page);
    await page.evaluate(async ({ positions, indices }) => {
      const { worker } = window.sdmLive;
      const { restarts } = worker;
      while (worker.restarts === restarts) {
        const abort = new AbortController();
        const made = worker.surface(positions, indices, { resolution: 2048, signal: abort.signal }).catch(() => {});
        abort.abort();
        await made;
        await new Promise((later) => setTimeout(later, 400));
      }
    }, ball(200, 1));
    await page.fill('#units', 'mm');
    await atRest(page, () => page.press('#units', 'Enter'));
    await isIdle(page);
    assert.deepStrictEqual((await numbers(page)).distance, before.distance);
    assert.strictEqual((await numbers(page)).units, 'mm');
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowLeft'));
    await agreesWithCommand(page);
  },

  // What the reference has is baked as the command bakes it, by each way to find points, and saved as a model with textures.
  async bakes(page) {
    const out = folder();
    const at = (name) => join(out, name);
    const [part, reference] = [ball(10, 1), ball(16, 1.05)];
    const wave = reference.positions.map((x, i) => 0.5 + 0.4 * Math.sin(3 * x + i % 3));
    const uvs = Array.from({ length: reference.positions.length / 3 }, (_, v) => [0, 1].map((k) => 0.5 + reference.positions[3 * v + k] / 2.2)).flat();
    const png = pngOf(32, 32, (x, y) => [255 * x, 255 * y, (Math.floor(8 * x) + Math.floor(8 * y)) % 2 ? 200 : 40]);
    writeFileSync(at('part.obj'), objOf(part));
    writeFileSync(at('colors.glb'), glbOf({ ...reference, colors: wave }));
    // Both skins of a thin shell, of which the part is nearer to the inner one.
    const inner = ball(16, 1.03).positions;
    const shell = { positions: [...reference.positions, ...inner], indices: [...reference.indices, ...reference.indices.map((v, i, all) => all[i - (i % 3) + ((3 - (i % 3)) % 3)] + inner.length / 3)] };
    writeFileSync(at('shell.glb'), glbOf({ ...shell, uvs: [...uvs, ...uvs.map((x) => 1 - x)], png }));
    await page.click('#tab-bake');
    const fill = (id, value) => page.evaluate(([field, text]) => {
      const input = document.getElementById(field);
      input.value = text;
      input.dispatchEvent(new Event('change'));
    }, [id, value]);
    const bakes = async (file, method, options) => {
      execFileSync(command, ['bake', at(file), at('part.obj'), '-o', at('out'), '--resolution', '256', '--atlas', 'charts', '--match', method, '--no-page', ...options], { stdio: 'pipe' });
      await page.waitForFunction(() => window.sdmLive.counts && window.sdmLive.atRest, null, { timeout: kPatience });
      const { texels } = JSON.parse(readFileSync(at('out/report.json'), 'utf8'));
      const counts = await page.evaluate(() => window.sdmLive.counts);
      const all = Object.values(texels).reduce((a, b) => a + b);
      for (const [key, n] of Object.entries(counts)) {
        const expected = texels[key.replace(/[A-Z]/, (letter) => `_${letter.toLowerCase()}`)];
        assert(Math.abs(n - expected) < 1e-3 * all, `${method}, ${key}: ${n} texels, ${expected} by the command`);
      }
      const picture = readFileSync(at('out/base_color.png')).toString('base64');
      const differing = await page.evaluate((text) => window.sdmLive.differing(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)), 1), picture);
      assert(differing < 2e-3, `${file}, ${method}: ${differing} of the texels differ from those of the command`);
      return counts;
    };
    await open(page, [at('part.obj'), at('colors.glb')]);
    await choose(page, ['bake-method', 'closest'], ['bake-shown', 'colors']);
    await bakes('colors.glb', 'closest', []);
    await open(page, [at('shell.glb')], '#open-reference');
    await bakes('shell.glb', 'closest', []);
    await choose(page, ['bake-method', 'facing']);
    await fill('bake-facing', '60');
    assert((await bakes('shell.glb', 'facing', ['--facing', '60'])).facing > 0);
    await choose(page, ['bake-method', 'ray']);
    await fill('bake-cage', '0.06');
    assert((await bakes('shell.glb', 'ray', ['--facing', '60', '--cage', '0.06'])).ray > 0);
    // Faces that all face away: nothing is baked, and it is said how much.
    writeFileSync(at('inside.glb'), glbOf({ ...grid(8), colors: grid(8).positions.map(() => 0.5) }));
    await open(page, [at('inside.glb')], '#open-reference');
    await choose(page, ['bake-method', 'facing']);
    await page.waitForFunction(() => window.sdmLive.counts?.facingAway > 0, null, { timeout: kPatience });
    assert.match(await page.textContent('#bake-words'), /have no point of the reference: nothing faces/);
    await open(page, [at('shell.glb')], '#open-reference');
    await page.waitForFunction(() => window.sdmLive.counts?.facing > 0, null, { timeout: kPatience });
    const glb = await savedModel(page, '#save-baked', 'baked.glb');
    const json = JSON.parse(glb.toString('utf8', 20, 20 + glb.readUInt32LE(12)));
    assert.deepStrictEqual(Object.keys(json.meshes[0].primitives[0].attributes).sort(), ['NORMAL', 'POSITION', 'TANGENT', 'TEXCOORD_0']);
    assert(json.materials[0].pbrMetallicRoughness.baseColorTexture && json.materials[0].normalTexture && json.images.length === 2, JSON.stringify(json.materials));
    // The picture in the file is the one that is shown.
    const view = json.bufferViews[json.images[json.textures[json.materials[0].pbrMetallicRoughness.baseColorTexture.index].source].bufferView];
    const binary = 20 + glb.readUInt32LE(12) + 8 + (view.byteOffset ?? 0);
    const picture = glb.subarray(binary, binary + view.byteLength).toString('base64');
    assert.strictEqual(await page.evaluate((text) => window.sdmLive.differing(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)), 0), picture), 0);
    // What the file refers to and is not there is said.
    writeFileSync(at('other.obj'), `mtllib lost.mtl\n${objOf(reference)}`);
    await open(page, [at('other.obj')], '#open-reference');
    await page.waitForFunction(() => /neither colours nor materials.*lost.mtl/.test(document.getElementById('bake-words').textContent), null, { timeout: kPatience });
    // Of a body without colours there are normals.
    await page.selectOption('#scene', 'letters');
    await page.waitForFunction(() => /neither colours nor materials/.test(document.getElementById('bake-words').textContent), null, { timeout: kPatience });
    await choose(page, ['bake-shown', 'normals']);
    await page.waitForFunction(() => window.sdmLive.counts, null, { timeout: kPatience });
    await choose(page, ['bake-shown', ''], ['facing', '60']);
    // Drawing the normals may come to rest only now.
    const end = Date.now() + kPatience;
    while (!/60/.test((await numbers(page)).measured?.text) && Date.now() < end) await isIdle(page);
    assert.match((await numbers(page)).measured.text, /60/);
  },

  // An animated file plays; each frame at rest is measured as the command measures it, also where the reference was moved or both
  // were swapped. Of an animation that cannot be played, the first frame is measured, and that is said.
  async films(page) {
    const out = folder();
    const [part, reference] = [ball(8, 1), ball(10, 1.2)];
    writeFileSync(join(out, 'part.obj'), objOf(part));
    writeFileSync(join(out, 'grows.glb'), glbOf({ ...reference, targets: [reference.positions.map((x) => 0.5 * x)] }));
    writeFileSync(join(out, 'skeleton.glb'), skeletonOf(ball(6, 0.4)));
    writeFileSync(join(out, 'short.glb'), glbOf({ ...reference, channels: [[0, 'translation', [0, 1, 2], [0, 0, 0]]] }));
    await open(page, [join(out, 'part.obj'), join(out, 'grows.glb')]);
    const first = await agreesWithCommand(page);
    const plays = async () => {
      const before = await page.textContent('#separation');
      await page.click('#play');
      await page.waitForFunction((old) => document.getElementById('separation').textContent !== old, before, { timeout: kPatience });
      await atRest(page, () => page.click('#play'));
      return agreesWithCommand(page, 3e-3);
    };
    const later = await plays();
    assert(later.distance.mean < first.distance.mean, `${first.distance.mean} became ${later.distance.mean}`);
    await page.focus('#canvas');
    await atRest(page, () => page.keyboard.press('Shift+ArrowRight'));
    await agreesWithCommand(page, 3e-3);
    await atRest(page, () => page.click('#swap'));
    await plays();
    await agreesWithPicture(page);
    await open(page, [join(out, 'skeleton.glb')], '#open-reference');
    assert.strictEqual(await page.textContent('#status'), '');
    await plays();
    await open(page, [join(out, 'short.glb')], '#open-reference');
    assert.match(await page.textContent('#status'), /^short.glb: the animation has 3 numbers for 3 keys of translation.*first frame is measured\.$/);
    await agreesWithCommand(page, 3e-3);
  },

  // Picture, numbers and model are files.
  async saves(page) {
    const save = async (id, name) => readFileSync(await saved(page, id, name));
    assert.strictEqual((await save('#save-picture', 'map.png')).subarray(1, 4).toString(), 'PNG');
    const csv = (await save('#save-numbers', 'numbers.csv')).toString();
    assert(csv.includes(`distance.mean,${(await numbers(page)).distance.mean}`), csv.slice(0, 300));
    const glb = await savedModel(page, '#save-model', 'model.glb');
    assert.deepStrictEqual([glb.toString('latin1', 0, 4), glb.readUInt32LE(8)], ['glTF', glb.length]);
  },

  // The report that is saved is a page with the same numbers.
  async reports(page) {
    const report = await opened(page.context(), pathToFileURL(await saved(page, '#save-report', 'report.html')).href, []);
    assert.strictEqual(await report.textContent('h1'), await page.textContent('h1'));
    assert.strictEqual(await report.textContent('#numbers-table tbody tr:first-child td'), await page.textContent('#numbers-table tbody tr:first-child td'));
  },

  // Every control has a name, headings are in order, and no text is wider than the window; the picture shows all of the part in a
  // window of any shape, and comes first on a phone. A limit that is not set looks so.
  async reads(page) {
    const session = await page.context().newCDPSession(page);
    const { nodes } = await session.send('Accessibility.getFullAXTree');
    const roles = new Set(['button', 'slider', 'spinbutton', 'textbox', 'combobox', 'checkbox', 'radio', 'link', 'image', 'img', 'application', 'table', 'region']);
    const named = nodes.filter((node) => !node.ignored && roles.has(node.role?.value));
    assert(named.length > 25, `${named.length} controls were found`);
    for (const node of named) assert(node.name?.value, `a ${node.role.value} without a name: ${JSON.stringify(node.properties)}`);
    const levels = await page.$$eval('h1, h2, h3', (list) => list.filter((h) => h.checkVisibility()).map((h) => Number(h.tagName[1])));
    levels.forEach((level, i) => assert(i === 0 ? level === 1 : level <= levels[i - 1] + 1, `headings ${levels}`));
    for (const [width, height] of [[1440, 900], [820, 1180], [390, 844]]) {
      await page.setViewportSize({ width, height });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert(wide <= width, `${wide} pixels in a window of ${width}`);
      await page.waitForFunction(() => window.sdmLive.atRest && window.sdmLive.fits, null, { timeout: kPatience });
    }
    const top = async (id) => (await page.locator(id).boundingBox()).y;
    assert((await top('#part')) < (await top('#compare')), 'on a phone, the picture is below the choices');
    const isUnset = () => page.evaluate(() => document.getElementById('tolerance').closest('.slider').classList.contains('unset'));
    assert(await isUnset());
    await page.fill('input[aria-label^="Tolerance"]', '1');
    assert(!(await isUnset()));
  },

  // Two files of 300,000 triangles each.
  async large(page) {
    const out = folder();
    writeFileSync(join(out, 'a.stl'), stlOf(ball(274, 1)));
    writeFileSync(join(out, 'b.stl'), stlOf(ball(274, 1.1)));
    await open(page, [join(out, 'a.stl'), join(out, 'b.stl')]);
    const of = await numbers(page);
    assert(of.o1.triangles > 299000 && of.o2.triangles > 299000, `${of.o1.triangles}`);
    assert(Math.abs(of.extremes.max.distance + 0.1) < 1e-3 && Math.abs(of.extremes.min.distance + 0.1) < 1e-3, JSON.stringify(of.extremes));
  },
};

/// From a server of this machine, with and without isolation from other origins.
async function served(browser, faults) {
  for (const headers of [{}, { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' }]) {
    const server = createServer((_, response) => response.writeHead(200, { 'Content-Type': 'text/html', ...headers }).end(readFileSync(file)));
    await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
    const page = await opened(await browser.newContext(), `http://127.0.0.1:${server.address().port}/live.html?scene=cloth&map=256`, faults);
    assert.strictEqual(await page.evaluate(() => window.crossOriginIsolated), Object.keys(headers).length > 0);
    assert.strictEqual((await numbers(page)).o1.file, 'cloth');
    await page.close();
    server.close();
  }
  // Before the program of the page runs there is no verdict, nor an empty badge in its place.
  const unscripted = await (await browser.newContext({ javaScriptEnabled: false })).newPage();
  await unscripted.goto(pathToFileURL(file).href);
  assert(!(await unscripted.isVisible('#verdict')), 'a badge without a verdict');
  await unscripted.context().close();
}

void inBrowser(async (browser, faults) => {
  for (const name of names) {
    const began = Date.now();
    try {
      if (name === 'served') await served(browser, faults);
      else {
        const context = await browser.newContext({ viewport: { width: 1000, height: 600 }, acceptDownloads: true });
        const page = await opened(context, address, faults);
        await page.waitForFunction(() => document.documentElement.dataset.rest, null, { timeout: kPatience });
        await checks[name](page);
        await context.close();
      }
      assert.deepStrictEqual(faults, []);
    } catch (error) {
      error.stack = `${name}: ${error.stack}`;
      throw error;
    }
    console.log(`${name}: ${((Date.now() - began) / 1000).toFixed(1)} s`);
  }
});
