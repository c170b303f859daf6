// Closest points and rays of geometries of three.js, against three.js. SDM_PACKAGE: the folder of the package; SDM_NODE_PACKAGES: that
// with three.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { pathToFileURL } from 'node:url';

// Installed beside three, as Node looks for three where the package is.
const folder = mkdtempSync(join(tmpdir(), 'sdm-three-'));
after(() => rmSync(folder, { recursive: true }));
mkdirSync(join(folder, 'node_modules'));
cpSync(process.env.SDM_PACKAGE, join(folder, 'node_modules/sdm'), { recursive: true });
symlinkSync(join(process.env.SDM_NODE_PACKAGES, 'node_modules/three'), join(folder, 'node_modules/three'));
writeFileSync(join(folder, 'all.mjs'), "export * as THREE from 'three';\nexport { GeometrySites } from 'sdm/three';\nexport { start } from 'sdm';\n");
const { THREE, GeometrySites, start } = await import(pathToFileURL(join(folder, 'all.mjs')));
const sdm = await start({ threads: 1 });

let seed = 7;
const random = (size) => ((seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5) * 2 * size;
const randomPoint = (size) => new THREE.Vector3(random(size), random(size), random(size));

/** A part of a torus, of which some faces are not drawn, and in groups. */
function drawnPart() {
  const geometry = new THREE.TorusGeometry(2, 0.7, 24, 48);
  geometry.setDrawRange(300, 3000);
  geometry.addGroup(0, 1500, 0);
  geometry.addGroup(1500, 1200, 1); // none has the rest
  return geometry;
}

test('closest points are those of all faces', () => {
  for (const geometry of [new THREE.TorusGeometry(2, 0.7, 24, 48), new THREE.TorusKnotGeometry(1, 0.3, 40, 8).toNonIndexed(), drawnPart()]) {
    const sites = new GeometrySites(sdm, geometry);
    const { index, drawRange } = geometry, position = geometry.getAttribute('position');
    const corner = (i) => new THREE.Vector3().fromBufferAttribute(position, index ? index.getX(i) : i);
    const end = Math.min(index?.count ?? position.count, drawRange.start + drawRange.count);
    const triangle = new THREE.Triangle(), at = new THREE.Vector3(), target = { point: new THREE.Vector3() };
    for (let n = 0; n < 40; ++n) {
      const point = randomPoint(4);
      let least = Infinity;
      for (let i = drawRange.start; i < end; i += 3) {
        triangle.set(corner(i), corner(i + 1), corner(i + 2)).closestPointToPoint(point, at);
        least = Math.min(least, at.distanceTo(point));
      }
      assert.equal(sites.closestPointToPoint(point, target), target);
      assert.ok(Math.abs(target.distance - least) < 1e-12, `${target.distance}, not ${least}`);
      assert.ok(Math.abs(target.point.distanceTo(point) - least) < 1e-12);
      const i = 3 * target.faceIndex;
      triangle.set(corner(i), corner(i + 1), corner(i + 2)).closestPointToPoint(target.point, at);
      assert.ok(i >= drawRange.start && i < end && at.distanceTo(target.point) < 1e-12, `face ${target.faceIndex}`);
      assert.equal(sites.closestPointToPoint(point, undefined, 0, 0.999 * least), null);
      assert.ok(Math.abs(sites.closestPointToPoint(point, undefined, 0, 1.001 * least).distance - least) < 1e-12);
    }
    sites.dispose();
  }
});

test('rays hit what those of three.js hit first', () => {
  const sides = [THREE.FrontSide, THREE.BackSide, THREE.DoubleSide].map((side) => new THREE.MeshBasicMaterial({ side }));
  const sheet = new THREE.PlaneGeometry(4, 4, 3, 3); // and its other side, at the same place
  sheet.setIndex([...sheet.index.array, ...sheet.index.array].map((vertex, i, { length }) => (i < length / 2 ? vertex : sheet.index.array[length - 1 - i])));
  let hit = 0, missed = 0;
  for (const geometry of [new THREE.TorusGeometry(2, 0.7, 24, 48), new THREE.TorusGeometry(2, 0.7, 12, 24).toNonIndexed(), drawnPart(), sheet])
    for (const material of [...sides, [sides[0], sides[2]], [sides[1], sides[0]]]) {
      const mesh = new THREE.Mesh(geometry, material), sites = new GeometrySites(sdm, geometry);
      mesh.position.copy(randomPoint(5));
      mesh.rotation.set(random(3), random(3), random(3));
      mesh.scale.set(1.5, -0.5, 2.5);
      mesh.updateMatrixWorld();
      for (let n = 0; n < 200; ++n) {
        const from = randomPoint(12), to = mesh.localToWorld(randomPoint(2));
        const raycaster = new THREE.Raycaster(from, to.sub(from).normalize(), n % 3 === 0 ? 4 : 0, n % 5 === 0 ? 9 : Infinity);
        const range = { ...geometry.drawRange };
        delete mesh.raycast;
        const [first] = raycaster.intersectObject(mesh);
        mesh.raycast = (caster, hits) => sites.raycast(mesh, caster, hits);
        const found = raycaster.intersectObject(mesh);
        assert.deepEqual(geometry.drawRange, range);
        assert.equal(found.length, first ? 1 : 0);
        first ? ++hit : ++missed;
        // Of the sheet, either side.
        if (first && geometry !== sheet) assert.deepEqual(found[0], first);
        else if (first) assert.ok(Math.abs(found[0].distance - first.distance) < 1e-12);
      }
    }
  assert.ok(hit > 300 && missed > 300, `${hit} hits, ${missed} misses`);
});

test('refit, and meshes that rays cannot be cast at', () => {
  const geometry = new THREE.SphereGeometry(1, 32, 16), sites = new GeometrySites(sdm, geometry);
  geometry.scale(2, 2, 2);
  sites.refit();
  assert.equal(sites.closestPointToPoint(new THREE.Vector3(0, 5, 0)).distance, 3);
  const raycaster = new THREE.Raycaster(new THREE.Vector3(0, 5, 0), new THREE.Vector3(0, -1, 0));
  const cast = (mesh) => () => sites.raycast(mesh, raycaster, []);
  assert.throws(cast(new THREE.Mesh(new THREE.BoxGeometry())), { kind: 'input', message: 'raycast needs a mesh of the geometry of these sites' });
  assert.throws(cast(new THREE.SkinnedMesh(geometry)), { kind: 'input', message: 'raycast needs a mesh that is neither skinned nor morphed' });
  const morphed = new THREE.Mesh(geometry);
  morphed.morphTargetInfluences = [0, 0.5];
  assert.throws(cast(morphed), { kind: 'input', message: /skinned nor morphed/ });
  morphed.morphTargetInfluences = [0, 0];
  assert.doesNotThrow(cast(morphed));
  sites.dispose();
  assert.throws(() => sites.closestPointToPoint(new THREE.Vector3()), { kind: 'input' });
});
