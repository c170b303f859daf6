// A ball whose right half is larger than the other mesh, with the colours of the tolerance, by three.js.
import * as THREE from 'three';
import { createWorker } from 'sdm';
import { DistanceMaterial, fromBufferGeometry, withAtlas } from 'sdm/three';

window.seen = async () => {
  const script = URL.createObjectURL(new Blob([window.embedded.script], { type: 'text/javascript' }));
  const core = Uint8Array.from(atob(window.embedded.core), (c) => c.charCodeAt(0));
  const worker = await createWorker({ threads: 1, modules: { core }, script });

  const geometry = new THREE.SphereGeometry(1, 64, 32), other = new THREE.SphereGeometry(1, 64, 32);
  const at = geometry.getAttribute('position');
  for (let i = 0; i < at.count; ++i) if (at.getX(i) > 0) at.setXYZ(i, 1.1 * at.getX(i), 1.1 * at.getY(i), 1.1 * at.getZ(i));
  const surface = await worker.surface(...fromBufferGeometry(geometry), { resolution: 512 });
  const map = await surface.map(await worker.sites(...fromBufferGeometry(other)));
  const atlas = await surface.atlas();
  const material = new DistanceMaterial(await map.arrays('distances'), atlas, { tolerance: [-0.05, 0.05], range: [-0.2, 0.2] });
  const mesh = new THREE.Mesh(withAtlas(geometry, atlas), material.clone());

  const scene = new THREE.Scene();
  scene.add(mesh, new THREE.AmbientLight(0xffffff, 3));
  const camera = new THREE.PerspectiveCamera(40, 1, 0.1, 10);
  camera.position.z = 4;
  const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
  renderer.setSize(400, 400);
  document.body.append(renderer.domElement);
  renderer.render(scene, camera);

  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [400, 400];
  const context = canvas.getContext('2d');
  context.drawImage(renderer.domElement, 0, 0);
  const { data } = context.getImageData(0, 0, 400, 400);
  let all = 0, above = 0, within = 0;
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b] = data.slice(i, i + 3);
    if (r + g + b < 10) continue;
    ++all;
    if (r > g + 20 && g > b) ++above;
    else if (g >= r && g >= b && g > 100) ++within;
  }
  return { above: above / all, within: within / all };
};

// The colormap and the range of distances.
window.scaleOf = (distances, options) => {
  const atlas = { resolution: distances.length, rows: 1, texelFaces: Uint32Array.from(distances, (_, i) => i) };
  const material = new DistanceMaterial({ distances: Float32Array.from(distances) }, atlas, options);
  return [material.colormap, ...material.range];
};

// The colours of distances, seen in front of a light that leaves them as they are.
window.colorsOf = (distances, options) => {
  const atlas = { resolution: distances.length, rows: 1, texelFaces: Uint32Array.from(distances, (_, i) => i) };
  const material = new DistanceMaterial({ distances: Float32Array.from(distances) }, atlas, options);
  const scene = new THREE.Scene();
  scene.add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material.clone()), new THREE.AmbientLight(0xffffff, Math.PI));
  const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
  renderer.setSize(20 * distances.length, 20);
  renderer.render(scene, new THREE.OrthographicCamera(-1, 1, 1, -1, -1, 1));
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [20 * distances.length, 20];
  const context = canvas.getContext('2d');
  context.drawImage(renderer.domElement, 0, 0);
  renderer.dispose();
  return distances.map((_, i) => Array.from(context.getImageData(20 * i + 10, 10, 1, 1).data.slice(0, 3)));
};
