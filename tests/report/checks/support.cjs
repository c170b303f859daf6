// What several checks of pages use.
const { readFileSync } = require('fs');

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

/// Waits for the fine picture of the last change.
async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await page.waitForFunction(() => (window.sdmPage ?? window.sdmPlayer ?? window.sdmBaked).view.atRest);
}
/// The picture on the canvas, when it is fine.
async function pictureOf(page) {
  await settled(page);
  return page.locator('#canvas').screenshot();
}

/// Of the opaque pixels of the canvas, the share that a function of red, green and blue accepts.
const shareOfPixels = (page, accepts) =>
  page.evaluate(`(() => {
    const canvas = document.getElementById('canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    const counts = [0, 0];
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 250) ++counts[(${accepts})(data[i], data[i + 1], data[i + 2]) ? 1 : 0];
    return counts[1] / (counts[0] + counts[1]);
  })()`);

module.exports = { numbers, plain, plyRows, hitsFrom, pictureOf, settled, shareOfPixels };
