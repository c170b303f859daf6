// The modules against the C++ library: SDM_PACKAGE is the folder of the package, SDM_REFERENCE that of js_reference's files.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

const { start } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const read = (name) => readFileSync(join(process.env.SDM_REFERENCE, name));
const numbers = (Kind, name) => {
  const bytes = read(name);
  return new Kind(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
};
const pairs = JSON.parse(read('pairs.json').toString());
const extent = (positions) => {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => ((low[i % 3] = Math.min(low[i % 3], x)), (high[i % 3] = Math.max(high[i % 3], x))));
  return Math.hypot(...low.map((x, k) => high[k] - x));
};

const kOfItself = {
  rings: { measure: 'self', rings: 2, maxDistance: 1.5 },
  geodesic: { measure: 'self', geodesic: 0.3 },
  ball: { measure: 'thickness', angle: 60 },
  ray: { measure: 'thickness', method: 'ray' },
};

for (const threads of [1, 2]) {
  test(`with ${threads} thread${threads > 1 ? 's' : ''}`, async (t) => {
    const sdm = await start({ threads, full: true });
    assert.equal(sdm.threads, threads);
    let texels = 0, different = 0;
    for (const [i, expected] of pairs.entries()) {
      await t.test(expected.name, () => {
        const mesh = (name) => [numbers(Float64Array, `${i}.${name}.positions`), numbers(Uint32Array, `${i}.${name}.indices`)];
        const [o1, o2] = [mesh('o1'), mesh('o2')];
        const size = extent(o1[0]) + extent(o2[0]);
        const uvs = numbers(Float64Array, `${i}.apart.uvs`);
        const surface = new sdm.Surface(...mesh('apart'), { resolution: 128, atlas: 'uv', uvs });
        const sites = new sdm.Sites(...o2);

        const agree = (own, name) => {
          const distances = numbers(Float32Array, `${i}.${name}`);
          assert.equal(own.length, distances.length);
          for (let texel = 0; texel < own.length; ++texel) {
            if (Number.isNaN(distances[texel])) {
              assert.ok(Number.isNaN(own[texel]));
              continue;
            }
            ++texels;
            if (own[texel] === distances[texel]) continue;
            ++different;
            assert.ok(Math.abs(own[texel] - distances[texel]) <= 1e-7 * size, `${name}, texel ${texel}: ${own[texel]}, not ${distances[texel]}`);
          }
        };
        const map = surface.map(sites);
        assert.deepEqual(surface.atlas().texelFaces, numbers(Uint32Array, `${i}.texel_faces`));
        agree(map.distances, 'distances');
        agree(surface.map(sites, { along: 'normal' }).distances, 'along.distances');
        agree(surface.map(sites, { along: [0.25, -0.5, 1] }).distances, 'upwards.distances');
        const itself = new sdm.Surface(...o1, { resolution: 64, storedAtlas: numbers(Uint8Array, `${i}.atlas`) }), own = new sdm.Sites(...o1);
        for (const name of expected.of_itself) agree(itself.map(own, kOfItself[name]).distances, `${name}.distances`);

        const points = numbers(Float64Array, `${i}.points`), closest = sites.closestPoints(points);
        const signed = numbers(Float64Array, `${i}.signed`), result = sites.signedDistance(points);
        for (let k = 0; k < signed.length; ++k) {
          assert.ok(Math.abs(closest.distances[k] - Math.abs(signed[k])) <= 1e-12 * size);
          assert.ok(Math.abs(result.distances[k] - signed[k]) <= 1e-12 * size);
        }

        const { larger } = new sdm.Sites(...o1).hausdorff(sites);
        assert.ok(larger.lower <= expected.hausdorff[1] && larger.upper >= expected.hausdorff[0]);
        const body = ([positions, indices]) => ({ positions, indices });
        const pair = new sdm.Pair(body(o1), body(o2));
        assert.ok(Math.abs(pair.separation().value - expected.separation) <= 1e-12 * size);
        assert.equal(pair.colliding(), expected.colliding);
        assert.equal(pair.contacts().depths.length, expected.contacts);
        for (const object of [surface, sites, map, pair, itself, own]) object.dispose();
      });
    }
    t.diagnostic(`${different} of ${texels} texels differ`);
    assert.ok(different <= 1e-5 * texels + 1);
    sdm.stop();
  });
}
