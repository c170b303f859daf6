// What the page saves: picture, numbers, model and report.
import { BufferAttribute, BufferGeometry, Mesh, MeshBasicMaterial, SRGBColorSpace, Color } from 'three';
import { kUnits } from 'sdm-rules';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { colorOf, type Scale } from '../src/color_scale';
import { byId, make } from '../src/dom';
import { download } from '../src/saved';
import type { Layout } from './layout';

interface Savable {
  picture: () => string; ///< a data: address
  csv: () => string;
  model: () => Promise<ArrayBuffer>;
  report: () => Promise<string>;
}

/// Metres in a unit; 1 for other names.
export const metresOf = (units: string): number => kUnits.find(([name]) => name === units)?.[1] ?? 1;

/// The part, coloured at its vertices, as a GLB. glTF has y up, and metres.
export async function glbOf(
  { model }: Layout,
  scale: Scale,
  up: 'y' | 'z',
  units: string,
): Promise<ArrayBuffer> {
  const { position, normal, distance, triangle, centre, size } = model;
  const toUp = (v: ArrayLike<number>, i: number) =>
    up === 'z' ? [v[i], v[i + 2], -v[i + 1]] : [v[i], v[i + 1], v[i + 2]];
  const points = new Float32Array(position.length);
  const normals = new Float32Array(position.length);
  const rgb = new Float32Array(position.length);
  const color = new Color();
  for (let i = 0; i < position.length; i += 3) {
    points.set(
      toUp(
        [0, 1, 2].map((k) => position[i + k] * size + centre[k]),
        0,
      ),
      i,
    );
    const n = toUp(normal, i);
    const length = Math.hypot(...n) || 1;
    normals.set(
      n.map((x) => x / length),
      i,
    );
    const [r, g, b] = colorOf(scale, distance[i / 3]);
    color.setRGB(r / 255, g / 255, b / 255, SRGBColorSpace).toArray(rgb, i);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  geometry.setAttribute('color', new BufferAttribute(rgb, 3));
  geometry.setAttribute(
    '_distance',
    new BufferAttribute(
      distance.map((d) => (Number.isNaN(d) ? 0 : d)),
      1,
    ),
  );
  geometry.setIndex(new BufferAttribute(triangle, 1));
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true }));
  mesh.name = 'part';
  mesh.scale.setScalar(metresOf(units));
  return (await new GLTFExporter().parseAsync(mesh, { binary: true })) as ArrayBuffer;
}

/// Buttons below the form.
export function addSaveButtons(
  { picture, csv, model, report }: Savable,
  fault: (error: unknown) => void,
): void {
  const button = (id: string, label: string, save: () => Promise<void> | void) =>
    make(
      'button',
      { type: 'button', id, click: () => void Promise.resolve().then(save).catch(fault) },
      label,
    );
  byId('form').append(
    make('p', { class: 'hint', id: 'save-title' }, 'Save'),
    button('save-picture', 'Picture (PNG)', () => {
      const link = make('a', { href: picture(), download: 'map.png' });
      link.click();
    }),
    button('save-numbers', 'Numbers (CSV)', () => download('numbers.csv', 'text/csv', csv())),
    button('save-model', 'Model (GLB)', async () =>
      download('model.glb', 'model/gltf-binary', await model()),
    ),
    button('save-report', 'Report (HTML)', async () => download('report.html', 'text/html', await report())),
  );
}
