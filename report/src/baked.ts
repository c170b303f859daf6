// Puts the pieces of the page of `sdm bake` together.
import { BakedData, BakedReport, readBaked } from './baked_data';
import { BakedView, Shading } from './baked_view';
import { byId, make, table } from './dom';
import { showMade } from './made';
import { count, percent, text } from './numbers';
import { openPage } from './open_page';
import { printPicture } from './print';

const nameOf = (file: string) => file.split(/[\\/]/).filter(Boolean).pop() ?? file;

class BakedPage {
  readonly view: BakedView;
  private readonly split = byId('split') as HTMLInputElement;
  private readonly divider = byId('divider');

  constructor(private readonly data: BakedData) {
    this.view = new BakedView(byId('view'), data, () => {});
    const { report } = data;
    for (const [which, { file }] of [
      ['low', report.low],
      ['high', report.high],
    ] as const) {
      byId(`name-${which}`).textContent =
        `${nameOf(file)}, ${which === 'low' ? 'with its textures' : 'detailed'}`;
      byId(`split-${which}`).textContent = nameOf(file);
    }
    this.split.addEventListener('input', () => this.show(Number(this.split.value) / 1000));
    this.split.setAttribute('aria-label', `Share of the picture that ${nameOf(report.low.file)} has`);
    this.dragDivider();
    this.view.canvas.addEventListener('keydown', (event) => this.turn(event));
    document.addEventListener('keydown', (event) => this.choose(event));
    printPicture(this.view);
    this.makeForm();
    this.show(0.5);
  }

  get firstPicture(): Promise<void> {
    return this.view.firstPicture;
  }

  /// Shows the coarse mesh in this share of the picture.
  private show(share: number): void {
    this.view.setShare(share);
    this.split.value = String(Math.round(1000 * share));
    this.split.setAttribute('aria-valuetext', percent(share));
    this.divider.style.left = `${100 * share}%`;
    byId('name-low').classList.toggle('outside', share < 0.2);
    byId('name-high').classList.toggle('outside', share > 0.8);
  }

  private dragDivider(): void {
    const move = (event: PointerEvent) => {
      if (!this.divider.hasPointerCapture(event.pointerId)) return;
      const { left, width } = byId('view').getBoundingClientRect();
      this.show(Math.min(1, Math.max(0, (event.clientX - left) / width)));
    };
    this.divider.addEventListener('pointerdown', (event) => this.divider.setPointerCapture(event.pointerId));
    this.divider.addEventListener('pointermove', move);
  }

  private turn(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.view.turn(-10, 0),
      ArrowRight: () => this.view.turn(10, 0),
      ArrowUp: () => this.view.turn(0, 10),
      ArrowDown: () => this.view.turn(0, -10),
      '+': () => this.view.zoom(0.85),
      '=': () => this.view.zoom(0.85),
      '-': () => this.view.zoom(1 / 0.85),
      Home: () => this.view.look('corner'),
    };
    const action = actions[event.key];
    if (!action) return;
    action();
    event.preventDefault();
  }

  private choose(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.target as HTMLElement).tagName === 'SELECT')
      return;
    const share = { l: 1, h: 0, b: 0.5 }[event.key.toLowerCase()];
    if (share !== undefined && !this.split.disabled) this.show(share);
  }

  private setBeside(beside: boolean): void {
    this.view.setBeside(beside);
    this.split.disabled = beside;
    this.divider.hidden = beside;
    this.show(0.5);
  }

  private makeForm(): void {
    const choice = (id: string, label: string, options: [string, string][], set: (value: string) => void) => {
      const select = make('select', { id, change: () => set(select.value) });
      for (const [value, name] of options) select.append(make('option', { value }, name));
      return make('div', { class: 'choice' }, make('label', { for: id }, label), select);
    };
    const edges = make('input', {
      type: 'checkbox',
      id: 'edges',
      change: () => this.view.setEdges(edges.checked),
    });
    byId('form').append(
      choice(
        'arrangement',
        'Meshes',
        [
          ['over', 'One over the other'],
          ['beside', 'Side by side'],
        ],
        (value) => this.setBeside(value === 'beside'),
      ),
      choice(
        'shading',
        'Shading',
        [
          ['lit', 'Colours in light'],
          ['colours', 'Colours alone'],
          ['shape', 'Shape alone'],
        ],
        (value) => this.view.setShading(value as Shading),
      ),
      make(
        'div',
        { class: 'check' },
        edges,
        make('label', { for: 'edges' }, `Triangles of ${nameOf(this.data.report.low.file)}`),
      ),
      make('button', { type: 'button', id: 'reset', click: () => this.view.look('corner') }, 'Look at all'),
    );
    byId('form').addEventListener('submit', (event) => event.preventDefault());
  }
}

function describe({ page, report, pictures }: BakedData): void {
  const [low, high] = [nameOf(report.low.file), nameOf(report.high.file)];
  const { resolution, rows } = report.atlas;
  byId('title').textContent = document.title = `${low}, baked from ${high}`;
  const channels = Object.keys(report.textures).length;
  byId('sentence').textContent =
    `${count(report.low.triangles)} triangles with ${channels === 1 ? 'one channel' : `${channels} channels`} of ${count(resolution)} × ${count(rows)} texels, ` +
    `from ${count(report.high.triangles)} triangles.`;
  const { triangles, triangles_of_mesh: all, divisions, fewer } = page.high;
  const parts = divisions > 1 ? `, with each of its triangles divided into ${divisions * divisions}` : '';
  const drawn = fewer
    ? `${high} is drawn by a coarser copy, ${count(triangles)} of ${count(all)} triangles, with its own colours and normals at their corners`
    : `${high} is drawn with its colours and normals at the corners of triangles${parts}`;
  const picture = pictures.values().next().value;
  const smaller =
    picture && picture.width < resolution
      ? ` Textures are shown with ${count(picture.width)} × ${count(picture.height)} texels; the files have all.`
      : '';
  byId('shown').textContent =
    `${drawn}. Both are drawn in the same light, with the roughness and the metal of their materials.${smaller}`;
}

function showNumbers({ atlas, texels, time_ms: time }: BakedReport): void {
  const all = Object.values(texels).reduce((sum, n) => sum + n, 0);
  const unit = atlas.samples > 1 ? 'Samples' : 'Texels';
  const row = (name: string, n: number) => [name, `${count(n)} (${percent(n / Math.max(1, all))})`];
  const ways: [string, number][] = [
    [`${unit} with the closest point`, texels.closest],
    [`${unit} with the closest point that faces them`, texels.facing],
    [`${unit} with a hit along the normal`, texels.ray],
    [`${unit} too far away, filled`, texels.too_far],
    [`${unit} that nothing faces, filled`, texels.facing_away],
  ];
  const rows = ways.filter(([, n], i) => n > 0 || i === 3).map(([name, n]) => row(name, n));
  const charts = atlas.charts === 1 ? 'one chart' : `${count(atlas.charts)} charts`;
  const layout = { uv: 'own UVs', charts, triangles: 'pairs of triangles' }[atlas.kind] ?? atlas.kind;
  rows.push(
    ['Layout', layout],
    ['Texels of faces', percent(atlas.utilisation)],
    ['Texels of several faces', count(atlas.overlapping_texels)],
    ['Time', `${text(time.total / 1000, 3)} s`],
  );
  byId('numbers-table').replaceChildren(table(['What', 'Number'], rows, 'Numbers'));
}

function showTextures({ report, pictures }: BakedData): void {
  const unit = report.units ? ` ${report.units}` : '';
  const rows = Object.entries(report.textures).map(([name, { file, values, picture }]) => [
    name.replace(/_/g, ' '),
    picture ? `${file}; ${picture.file}, ${text(picture.lower)} to ${text(picture.upper)}${unit}` : file,
    values,
  ]);
  byId('textures-table').replaceChildren(table(['Channel', 'File', 'Values'], rows, 'Channels'));
  byId('pictures').replaceChildren(
    ...[...pictures].map(([name, picture]) => {
      const canvas = make('canvas', {
        width: 192,
        height: Math.max(1, Math.round((192 * picture.height) / picture.width)),
        role: 'img',
        'aria-label': `The texture ${name.replace(/_/g, ' ')}`,
      });
      canvas.getContext('2d')!.drawImage(picture, 0, 0, canvas.width, canvas.height);
      return make('figure', {}, canvas, make('figcaption', {}, name.replace(/_/g, ' ')));
    }),
  );
}

function showMethod(report: BakedReport): void {
  const { match, facing, cage, max_distance: most, units, notes } = report;
  const length = (x: number) => `${text(x)}${units ? ` ${units}` : ''}`;
  const [low, high] = [nameOf(report.low.file), nameOf(report.high.file)];
  const allowed = `faces within ${text(facing)}° of the texel's`;
  const words = {
    closest: `Each texel of ${low} has what ${high} has at its closest point.`,
    facing: `Each texel of ${low} has what ${high} has at the closest point of the ${allowed}.`,
    ray: `Each texel of ${low} has what ${high} has at the nearest hit along its normal${cage === null ? '' : `, at most ${length(cage)} away,`} on ${allowed}, or else at the closest point of these.`,
  }[match];
  const limit = most === null ? '' : ` What is farther than ${length(most)} does not count.`;
  byId('method-text').replaceChildren(
    make('p', {}, words + limit),
    ...notes.map((note) => make('p', { class: 'note' }, note)),
  );
}

void openPage('sdmBaked', 'meshes', 'The numbers are below. Is WebGL 2 on in this browser?', async () => {
  const data = await readBaked();
  const { report, page } = data;
  describe(data);
  showNumbers(report);
  showTextures(data);
  showMethod(report);
  showMade([report.high, report.low], page);
  return new BakedPage(data);
});
