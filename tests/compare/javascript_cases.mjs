// Calls of the npm package. `core` and `full` are its two modules, `file` reads an input, and meshes have `positions`, `indices` and
// `all`, a list of both.
export const calls = [
  ({ sdm }) => Object.fromEntries(Object.entries(sdm).map(([name, value]) => [name, typeof value])),
  ({ core, ball }) => new core.Sites(...ball.all),
  ({ core, ground }) => new core.Sites(...ground.all),
  ({ core, ball, apart }) => new core.Sites(...ball.all).closestPoints(apart.positions),
  ({ core, ball, apart }) => new core.Sites(...ball.all).closestPoints(apart.positions, { maxDistance: 2 }),
  ({ core, ball, box }) => new core.Sites(...ball.all).signedDistance(box.positions),
  ({ core, ground, box }) => new core.Sites(...ground.all).signedDistance(box.positions),
  ({ core, ground, box }) => new core.Sites(...ground.all).signedDistance(box.positions, { sign: 'exact' }),
  ({ core, ground, box }) => new core.Sites(...ground.all).signedDistance(box.positions, { sign: 'winding' }),
  ({ core, ball, apart }) => new core.Sites(...ball.all).firstHits(apart.positions, apart.positions.map((x) => -x)),
  ({ core, ball }) => new core.Sites(...ball.all).firstHits([0, 0, 5], [0, 0, 0]),
  ({ core, ball, box }) => new core.Sites(...ball.all).hausdorff(new core.Sites(...box.all)),
  ({ core, ball, soup }) => new core.Sites(...ball.all).hausdorff(new core.Sites(...soup.all), { precision: 0.01 }),
  ({ core, ball, box }) => new core.Sites(...ball.all).hausdorff(new core.Sites(...box.all), { precision: 0 }),
  ({ core, ball, larger }) => {
    const sites = new core.Sites(...ball.all);
    sites.refit(larger.positions);
    return sites.closestPoints([0, 0, 3]);
  },
  ({ core }) => new core.Sites([0, 0, NaN, 1, 0, 0, 0, 1, 0]),
  ({ core }) => new core.Sites([0, 0]),
  ({ core }) => new core.Sites([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 9]),
  ({ core }) => new core.Sites('a mesh'),
  ({ core, ball }) => new core.Sites(...ball.all).closestPoints([0, 0, 0], { maxDistnace: 1 }),
  ({ core, ball }) => new core.Surface(...ball.all, { resolution: 64 }).atlas(),
  ({ core, ball }) => new core.Surface(...ball.all, { resolution: 128, atlas: 'triangles', gutter: 2 }).atlas(),
  ({ core, ball }) => new core.Surface(...ball.all, { resolution: 64 }).samples(),
  ({ core, ball }) => new core.Surface(...ball.all, { resolution: 64 }).sampleCounts(),
  ({ core, ball }) => new core.Surface(...ball.all, { resolution: 3 }),
  ({ core, ball }) => new core.Surface(...ball.all, { atlas: 'uv' }),
  ({ core, ball }) => new core.Surface(...ball.all, { resolutoin: 64 }),
  ({ core, ball, box }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...box.all)),
  ({ full, ball, box }) => new full.Surface(...ball.all, { resolution: 64 }).map(new full.Sites(...box.all)),
  ({ core, ball, box }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...box.all)).statistics(),
  ({ core, ball, box }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...box.all), { maxDistance: 0.5 }),
  ({ core, ball, ground }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...ground.all), { sign: 'side' }),
  ({ core, dented, plate }) => new core.Surface(...dented.all, { resolution: 64 }).map(new core.Sites(...plate.all), { facing: 90 }),
  ({ core, dented, plate }) => new core.Surface(...dented.all, { resolution: 64 }).map(new core.Sites(...plate.all), { facing: 200 }),
  ({ core, ball, box }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...box.all)).transfer([0, 1, 2, 3, 4, 5, 6, 7]),
  ({ core, ball, box }) => new core.Surface(...ball.all, { resolution: 64 }).map(new core.Sites(...box.all), { progress: () => false }),
  ({ core, ball, box }) => {
    const surface = new core.Surface(...ball.all, { resolution: 64 });
    const map = surface.emptyMap(new core.Sites(...box.all)), { samples, grain } = surface.sampleCounts();
    map.computeSamples(0, Math.min(grain, samples));
    return map.valuesOfSamples(0, Math.min(grain, samples));
  },
  ({ full, larger, ball }) => new full.Surface(...larger.all, { resolution: 64 }).map(new full.Sites(...ball.all)).summary({ tolerance: [-0.1, 0.1], units: 'mm' }),
  ({ full, larger, ball }) => new full.Surface(...larger.all, { resolution: 64 }).map(new full.Sites(...ball.all)).summary({ tolerance: [0.1, 0.2] }),
  ({ full, dented, plate }) => new full.Surface(...dented.all, { resolution: 64 }).map(new full.Sites(...plate.all)).summary({ tolerance: [-0.4, 0.4] }),
  ({ full, larger, ball }) => new full.Surface(...larger.all, { resolution: 64 }).map(new full.Sites(...ball.all)).summary({ tolerance: [1, 0] }),
  ({ full, larger, ball }) => new full.Surface(...larger.all, { resolution: 64 }).map(new full.Sites(...ball.all)).report({ tolerance: [-0.1, 0.1] }),
  ({ core, larger, ball }) => new core.Surface(...larger.all, { resolution: 64 }).map(new core.Sites(...ball.all)).summary(),
  ({ full, file }) => full.readMesh(file('named.obj'), 'named.obj'),
  ({ full, file }) => full.readMesh(file('textured.glb'), 'textured.glb'),
  ({ full, file }) => full.readMesh(file('index.obj'), 'index.obj'),
  ({ full, file }) => full.readMesh(file('cut.ply'), 'cut.ply'),
  ({ full, file }) => full.readAnimation(file('animated.glb'), 'animated.glb').positions(1),
  ({ full, file }) => full.readLook(file('textured.glb'), 'textured.glb').textures(),
  ({ full, ball, beside }) => {
    const pair = new full.Pair(ball, beside, { contactMargin: 0.1 });
    return [pair.separation(), pair.colliding(), pair.penetrationDepth(), pair.contacts()];
  },
  ({ full, ball, box }) => {
    const pair = new full.Pair(ball, box);
    pair.setPose(1, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]);
    return [pair.separation(), pair.colliding()];
  },
  ({ full, ball, box }) => new full.Pair(ball, box).setPose(2, [1]),
  ({ full, dented, plate }) => full.match(new full.Surface(...dented.all, { resolution: 64 }), new full.Sites(...plate.all), { method: 'ray', cage: 1 }).arrays(),
  ({ full, dented, plate }) => full.match(new full.Surface(...dented.all, { resolution: 64 }), new full.Sites(...plate.all)).normals({ tangentSpace: true }),
  ({ full, larger, file }) => {
    const { positions, indices } = full.readMesh(file('colors.ply'), 'colors.ply');
    const matches = full.match(new full.Surface(...larger.all, { resolution: 64 }), new full.Sites(positions, indices));
    return [matches.counts(), matches.bake(full.readLook(file('colors.ply'), 'colors.ply')), matches.model()];
  },
  async ({ sdm, ball, box }) => {
    const worker = await sdm.createWorker({ threads: 1 });
    const surface = await worker.surface(...ball.all, { resolution: 64 });
    const map = await surface.map(await worker.sites(...box.all));
    return [await map.arrays('distances'), await map.statistics()];
  },
  async ({ sdm }) => (await sdm.createWorker({ threads: 1 })).sites([0, 0]),
  async ({ sdm }) => sdm.start({ thread: 1 }),
];
