// An app of the package and three.js: what it measures, in Node as in pages of each bundler.
import { createWorker, start } from 'sdm';
import { DistanceMaterial, fromBufferGeometry, withAtlas } from 'sdm/three';
import { SphereGeometry } from 'three';

export async function measured() {
  const part = new SphereGeometry(1, 24, 12);
  const other = fromBufferGeometry(new SphereGeometry(1.25, 16, 12));
  const sdm = await start();
  const { distances: alone } = new sdm.Sites(...other).closestPoints([0, 0, 0, 2, 0, 0, 0.3, 0.4, 0.5]);

  const worker = await createWorker({ full: true, threads: 1 });
  const surface = await worker.surface(...fromBufferGeometry(part), { resolution: 64 });
  const map = await surface.map(await worker.sites(...other));
  const { distances } = await map.arrays('distances');
  const { verdict } = (await map.summary({ tolerance: [0.1, 0.3] })).tolerance;
  const report = await map.report({ tolerance: [0.1, 0.3] });
  const atlas = await surface.atlas();
  worker.terminate();
  sdm.stop();

  const material = new DistanceMaterial({ distances }, atlas, {});
  return {
    alone: [...alone],
    distances: [...distances].filter((d) => !Number.isNaN(d)),
    verdict,
    reported: report.includes('"verdict"') && report.includes('</html>'),
    range: [...material.range],
    vertices: withAtlas(part, atlas).getAttribute('position').count,
  };
}
