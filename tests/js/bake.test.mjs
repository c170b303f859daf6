// Looks, matches and animations: the module `full`. SDM_PACKAGE: the folder of the package.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

const { createWorker, kMatchKinds, start } = await import(pathToFileURL(join(process.env.SDM_PACKAGE, 'node.js')));
const { ball, glbOf, objOf, skeletonOf } = createRequire(import.meta.url)('../live/meshes.cjs');
const sdm = await start({ full: true });
const part = ball(10, 1), other = ball(16, 1.05);
const surface = new sdm.Surface(part.positions, part.indices, { resolution: 128 });
const sites = new sdm.Sites(other.positions, other.indices);
const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

/** Values of the vertices of `other` at a match. */
function at({ faces, barycentric }, texel, values) {
  const [b, c] = barycentric.subarray(2 * texel);
  const [u, v, w] = other.indices.slice(3 * faces[texel], 3 * faces[texel] + 3).map((vertex) => values[vertex]);
  return (1 - b - c) * u + b * v + c * w;
}

test('colours of vertices are baked where their points are', () => {
  const colors = other.positions.map((x) => 0.5 + 0.4 * x);
  const look = sdm.readLook(glbOf({ ...other, colors }), 'colors.glb');
  assert.deepEqual([look.hasMaterials, look.hasColors, look.hasNormals, look.textures()], [false, true, false, []]);
  const matches = sdm.match(surface, sites, { method: 'closest' });
  const arrays = matches.arrays(), counts = matches.counts();
  assert.equal(counts.closest, arrays.kinds.filter((kind) => kMatchKinds[kind] === 'closest').length);
  assert.deepEqual([counts.facing, counts.tooFar, counts.facingAway], [0, 0, 0]);
  const { textures } = matches.bake(look), { components, data } = textures[0];
  assert.deepEqual(textures.map(({ channel }) => channel), ['base_color']);
  const red = colors.filter((_, i) => i % 3 === 0), transferred = matches.transfer(Float32Array.from(red));
  let texels = 0;
  arrays.kinds.forEach((kind, texel) => {
    if (kind === 0) return;
    ++texels;
    const expected = at(arrays, texel, red);
    assert.ok(Math.abs(transferred[texel] - expected) < 1e-6);
    assert.ok(Math.abs(linear(data[components * texel] / 255) - expected) < 0.01, `${data[components * texel]} for ${expected}`);
  });
  assert.ok(texels > 5000 && transferred.every(Number.isFinite), 'free texels are filled');
});

test('textures are sampled from pictures that the caller has decoded', () => {
  const uvs = Array.from({ length: other.positions.length / 3 }, (_, v) => [0.25 + 0.5 * (other.positions[3 * v] > 0 ? 1 : 0), 0.5]).flat();
  const look = sdm.readLook(glbOf({ ...other, uvs, png: Buffer.from('a picture') }), 'texture.glb');
  assert.deepEqual(look.textures().map(({ bytes }) => Buffer.from(bytes).toString()), ['a picture']);
  look.setPicture(0, { width: 2, height: 1, data: Uint8Array.of(255, 0, 0, 255, 0, 0, 255, 255) });
  const matches = sdm.match(surface, sites), { kinds, faces } = matches.arrays(), { components, data } = matches.bake(look).textures[0];
  let seen = 0;
  kinds.forEach((kind, texel) => {
    if (kind === 0) return;
    const sides = other.indices.slice(3 * faces[texel], 3 * faces[texel] + 3).map((v) => other.positions[3 * v] > 0);
    if (sides.some((side) => side !== sides[0])) return;
    ++seen;
    assert.deepEqual([...data.subarray(components * texel, components * texel + 3)], sides[0] ? [0, 0, 255] : [255, 0, 0]);
  });
  assert.ok(seen > 5000);
  assert.throws(() => look.setPicture(0, { width: 2, height: 2, data: new Uint8Array(4) }), { kind: 'input', message: /needs 16 numbers/ });
  assert.throws(() => look.setPicture(1, { width: 1, height: 1, data: new Uint8Array(4) }), { kind: 'input', message: /no texture/ });
});

test('facing and rays pass what faces away, and what is too far is counted', () => {
  const inside = new sdm.Sites(other.positions, other.indices.map((_, i, all) => all[i - (i % 3) + 2 - (i % 3)]).concat());
  assert.ok(inside.closed);
  const sheet = { positions: [-3, -3, 2, 3, -3, 2, 0, 3, 2], indices: [0, 2, 1] };  // looks down
  const below = new sdm.Surface([-1, -1, 0, 1, -1, 0, 0, 1, 0], [0, 1, 2], { resolution: 64 });
  const faces = sdm.match(below, new sdm.Sites(sheet.positions, sheet.indices), { method: 'facing', facing: 60 }).counts();
  assert.ok(faces.facingAway > 100 && faces.facing === 0, JSON.stringify(faces));
  const far = sdm.match(surface, sites, { method: 'closest', maxDistance: 0.01 }).counts();
  assert.ok(far.tooFar > 5000 && far.closest === 0, JSON.stringify(far));
  const rays = sdm.match(surface, sites, { method: 'ray', cage: 0.2 }).counts();
  assert.ok(rays.ray > 5000 && rays.tooFar === 0, JSON.stringify(rays));
  assert.throws(() => sdm.match(surface, sites, { method: 'nearest' }), { kind: 'input' });
  assert.throws(() => sdm.match(surface, sites, { facing: 0 }), { kind: 'input' });
});

test('normals are those of the mesh, turn with a pose of a file, and have a tangent space', () => {
  const matches = sdm.match(surface, sites), { kinds, ...arrays } = matches.arrays();
  const object = matches.normals(), tangent = matches.normals({ tangentSpace: true });
  kinds.forEach((kind, texel) => {
    if (kind === 0) return;
    const n = [0, 1, 2].map((k) => at(arrays, texel, other.positions.filter((_, i) => i % 3 === k)) / 1.05);
    for (let k = 0; k < 3; ++k) assert.ok(Math.abs(2 * (object[3 * texel + k] / 255) - 1 - n[k]) < 0.06, `${object[3 * texel + k]} for ${n[k]}`);
    assert.ok(tangent[3 * texel + 2] > 200, 'along the normal of the part');
  });
  const model = matches.model({ tangents: true }), vertices = model.positions.length / 3;
  assert.deepEqual([model.normals.length, model.uvs.length, model.tangents.length, model.indices.length], [3 * vertices, 2 * vertices, 4 * vertices, part.indices.length]);
  for (let v = 0; v < vertices; ++v) assert.ok(Math.abs(Math.hypot(...model.positions.subarray(3 * v, 3 * v + 3)) - 1) < 1e-6);
  assert.throws(() => matches.normals({ pose: [1] }), { kind: 'input', message: /16 numbers/ });
});

test('animations of morph targets have the frames of the file', async () => {
  const grown = part.positions.map((x) => 0.5 * x), moved = part.positions.map((_, i) => (i % 3 === 2 ? 1 : 0));
  const bytes = glbOf({ ...part, targets: [grown, moved] });
  const worker = await createWorker({ full: true });
  const animation = await worker.readAnimation(bytes, 'a.glb', { rate: 10 });
  assert.equal(animation.frames, 21);
  const { positions, indices } = await animation.mesh();
  assert.deepEqual([positions.length, indices.length], [part.positions.length, part.indices.length]);
  const close = (values, of) => values.forEach((x, i) => assert.ok(Math.abs(x - of(part.positions[i], i)) < 1e-6));
  close(await animation.positions(5), (x) => 1.25 * x);
  close(await animation.positions(20), (x, i) => 1.5 * x + (i % 3 === 2 ? 1 : 0));
  await assert.rejects(animation.positions(21), { kind: 'input', message: /no frame/ });
  assert.equal(await worker.readAnimation(glbOf(part), 'still.glb'), null);
  assert.equal(await worker.readAnimation(Buffer.from(objOf(part)), 'still.obj'), null);
  await assert.rejects(worker.readAnimation(bytes.subarray(0, 500), 'cut.glb'), { kind: 'input', message: /^cut.glb: / });
  await assert.rejects(worker.readAnimation(bytes, 'a.glb', { rate: 0 }), { kind: 'input', message: /rate/ });
  worker.terminate();
});

test('animations of nodes and skins have the frames that three.js shows', async () => {
  const packages = join(process.env.SDM_NODE_PACKAGES, 'node_modules/three');
  const { AnimationMixer, Vector3 } = await import(pathToFileURL(join(packages, 'build/three.module.js')));
  const { GLTFLoader } = await import(pathToFileURL(join(packages, 'examples/jsm/loaders/GLTFLoader.js')));
  const bytes = skeletonOf(ball(4, 0.4));
  const { scene, animations } = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
  const mixer = new AnimationMixer(scene);
  const action = mixer.clipAction(animations[0]);
  action.play();
  /// The vertices of all meshes, in the order of the nodes.
  const shown = (time) => {
    action.time = time;
    mixer.update(0);
    scene.updateMatrixWorld(true);
    const all = [];
    scene.traverse((mesh) => {
      for (let v = 0; mesh.isMesh && v < mesh.geometry.attributes.position.count; ++v)
        all.push(...mesh.getVertexPosition(v, new Vector3()).applyMatrix4(mesh.matrixWorld));
    });
    return all;
  };
  const animation = sdm.readAnimation(bytes, 'skeleton.glb', { rate: 20 });
  assert.equal(animation.frames, 41);
  let moved = 0;
  const before = shown(0);
  for (let frame = 0; frame < 40; ++frame) { // the last time is the first one of a clip that repeats
    const expected = shown(frame / 20);
    const positions = animation.positions(frame);
    assert.equal(positions.length, expected.length);
    expected.forEach((x, i) => {
      assert.ok(Math.abs(x - positions[i]) < 5e-6, `coordinate ${i} of frame ${frame}: ${positions[i]}, and ${x} in three.js`);
      moved = Math.max(moved, Math.abs(x - before[i]));
    });
  }
  assert.ok(moved > 1, `moved by ${moved}`);
  animation.dispose();
});

test('animations that are damaged are one sentence', () => {
  const channel = (...rest) => glbOf({ ...part, channels: [[0, ...rest]] });
  const fails = (bytes, message) => {
    const file = { kind: 'input', message };
    assert.throws(() => sdm.readAnimation(bytes, 'a.glb'), file);
  };
  fails(channel('translation', [0, 1], [0, 0, 0]), /^a.glb: the animation has 3 numbers for 2 keys of translation/);
  fails(channel('rotation', [0, 1], [0, 0, 0, 1, 0, 0, 0, 0]), /^a.glb: .*quaternion of length 0/);
  fails(glbOf({ ...part, channels: [[7, 'translation', [0, 1], [0, 0, 0, 1, 0, 0]]] }), /^a.glb: item 7 of nodes/);
});

test('matches and looks of a worker keep what they need, and are of one worker', async () => {
  const [worker, another] = await Promise.all([createWorker({ full: true }), createWorker({ full: true })]);
  const matches = await worker.match(await worker.surface(part.positions, part.indices, { resolution: 128 }), await worker.sites(other.positions, other.indices), { method: 'closest' });
  const look = await worker.readLook(glbOf({ ...other, colors: other.positions.map(() => 0.25) }), 'grey.glb');
  const { textures, material } = await matches.bake(look);
  assert.equal(textures[0].data[0], 137); // 0.25 in sRGB
  assert.deepEqual([material.alphaMode, material.roughness], ['opaque', 1]);
  assert.equal((await matches.normals({ look })).length, 3 * 128 * 128);
  await assert.rejects(matches.bake(await another.readLook(glbOf(other), 'b.glb')), { kind: 'input', message: /different workers/ });
  look.dispose();
  await assert.rejects(matches.bake(look), { kind: 'input', message: /disposed/ });
  worker.terminate();
  another.terminate();
});

test('other modules say what is needed', async () => {
  const core = await start({ threads: 1 });
  assert.throws(() => core.readLook(glbOf(other), 'a.glb'), { kind: 'input', message: /full: true/ });
  assert.throws(() => core.match(new core.Surface(part.positions, part.indices), new core.Sites(other.positions, other.indices)), { kind: 'input', message: /full: true/ });
});
