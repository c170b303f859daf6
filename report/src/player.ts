// Puts the pieces of player.html together.
import { kViridisInWords, Mode, Scale } from './color_scale';
import { byId, make } from './dom';
import { drawLegend } from './legend';
import { showMade } from './made';
import { count, signedText, typedNumber } from './numbers';
import { openPage } from './open_page';
import { Chart } from './player_charts';
import { distancesOf, hasSigns, placeFrame, PlayerData, readPlayer } from './player_data';
import { encloses, PlayerView } from './player_view';
import { showVerdict } from './player_verdict';
import { Mark, Worst, worstOf } from './player_worst';
import { printPicture } from './print';

const kSpeeds: [string, number][] = [
  ['5 frames a second', 5],
  ['15 frames a second', 15],
  ['30 frames a second', 30],
  ['60 frames a second', 60],
];

class Player {
  private frame = 0; // among those in the page
  private playing = false;
  private isNear = false; // the view is of the worst frame alone, and not the user's
  private perSecond = 30;
  private scale: Scale;
  private readonly time = byId('time') as HTMLInputElement;
  private readonly play = byId('play') as HTMLButtonElement;
  private readonly charts: Chart[];
  private readonly view: PlayerView;
  private readonly worst: Worst | null;
  private readonly mark: Mark | null;

  constructor(private readonly data: PlayerData) {
    const { page } = data;
    this.view = new PlayerView(byId('view'), data, () => this.mark?.update());
    this.worst = worstOf(data);
    const text =
      this.worst &&
      `${signedText(this.worst.distance, hasSigns(data), 3)}${page.units ? `\u00a0${page.units}` : ''} at a vertex`;
    this.mark = text === null ? null : new Mark(this.view, text);
    this.scale = { ...page.scale };
    this.time.max = String(page.shown.length - 1);
    this.time.addEventListener('input', () => this.show(Number(this.time.value)));
    this.play.addEventListener('click', () => this.toggle());
    document.addEventListener('keydown', (event) => this.key(event));
    const pick = (place: number) => this.show(this.nearest(place));
    // O1 and O2 in titles are the bodies.
    const named = (title: string) =>
      title.replace(/\bO([12])\b/g, (_, which: string) => nameOf(data, Number(which) - 1));
    this.charts = page.panels.map(
      (panel) => new Chart({ ...panel, title: named(panel.title) }, page.added, page.units, pick),
    );
    byId('charts').replaceChildren(...this.charts.map(({ element }) => element));
    const drawCharts = () => this.charts.forEach((chart) => chart.draw(chart.element.clientWidth));
    drawCharts();
    new ResizeObserver(drawCharts).observe(byId('charts'));
    const kOnPaper = 336; // pixels of a chart, of which there are two in a row
    window.addEventListener('beforeprint', () => this.charts.forEach((chart) => chart.draw(kOnPaper)));
    window.addEventListener('afterprint', drawCharts);
    printPicture(this.view);
    for (const type of ['pointerdown', 'wheel'])
      this.view.canvas.addEventListener(type, () => (this.isNear = false), { passive: true });
    this.makeForm();
    this.recolour();
    this.show(0);
    this.showWorst();
    showVerdict(data, pick);
  }

  get firstPicture(): Promise<void> {
    return this.view.firstPicture;
  }

  /// Shows the frame of the worst place, with this in front.
  private showWorst(): void {
    if (!this.worst) return;
    this.show(this.worst.frame);
    this.isNear = true;
    if (this.view.lookFrom(this.worst)) return;
    // It is inside of the other body.
    const select = byId(`style${1 - this.worst.body}`) as HTMLSelectElement;
    if (select.value === 'solid') {
      select.value = 'ghost';
      select.dispatchEvent(new Event('change'));
    }
    this.view.lookFrom(this.worst);
  }

  /// The frame of the page that is nearest to a place among all frames.
  private nearest(place: number): number {
    return Math.min(this.data.page.shown.length - 1, Math.round(place / this.data.page.stride));
  }

  show(frame: number): void {
    const { page } = this.data;
    this.frame = Math.min(page.shown.length - 1, Math.max(0, frame));
    const place = page.shown[this.frame];
    this.view.show(this.frame);
    this.time.value = String(this.frame);
    this.time.setAttribute('aria-valuetext', `frame ${page.added[place]}`);
    byId('frame').textContent =
      `frame ${page.added[place]} (${page.added[0]} to ${page.added[page.added.length - 1]})`;
    this.mark?.show(this.worst && this.frame === this.worst.frame ? this.view.at(this.worst) : null);
    for (const chart of this.charts) chart.show(place);
  }

  private lookAtAll(): void {
    this.isNear = false;
    this.view.lookAtAll();
  }

  private toggle(): void {
    this.playing = !this.playing;
    this.play.textContent = this.playing ? 'Stop' : 'Play';
    this.play.setAttribute('aria-pressed', String(this.playing));
    if (!this.playing) return;
    if (this.isNear) this.lookAtAll();
    if (this.frame === this.data.page.shown.length - 1) this.show(0);
    const begin = performance.now();
    const first = this.frame;
    const perSecond = this.perSecond / this.data.page.stride;
    const step = (now: number) => {
      if (!this.playing) return;
      const next = (first + Math.floor(((now - begin) / 1000) * perSecond)) % this.data.page.shown.length;
      if (next !== this.frame) this.show(next);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|BUTTON)$/.test(target.tagName))
      return;
    if (event.key === ' ') this.toggle();
    else if (event.key === 'ArrowRight') this.show(this.frame + 1);
    else if (event.key === 'ArrowLeft') this.show(this.frame - 1);
    else if (event.key === 'Home') this.show(0);
    else if (event.key === 'End') this.show(this.data.page.shown.length - 1);
    else return;
    event.preventDefault();
  }

  private recolour(): void {
    const { page, bodies } = this.data;
    this.view.setScale(this.scale);
    const missing = bodies.some(({ distances }) => distances?.includes(65535));
    drawLegend(this.scale, 'distance', page.units, missing);
  }

  private makeForm(): void {
    const { page } = this.data;
    const choice = (
      id: string,
      label: string,
      options: [string, string][],
      value: string,
      set: (value: string) => void,
    ) => {
      const select = make('select', { id, change: () => set(select.value) });
      for (const [key, name] of options)
        select.append(make('option', { value: key, selected: key === value }, name));
      return make('div', { class: 'choice' }, make('label', { for: id }, label), select);
    };
    const modes: [Mode, string][] = [
      ['viridis', kViridisInWords],
      ['sequential', 'From zero, the other side in red'],
      ['diverging', 'Blue, white, red'],
      ['paper2006', 'Red to green'],
    ];
    if (page.scale.mode === 'tolerance') modes.unshift(['tolerance', 'Tolerance bands']);
    const range = make('input', {
      type: 'text',
      inputmode: 'decimal',
      autocomplete: 'off',
      id: 'range',
      value: Number(this.scale.hi.toPrecision(4)),
      input: () => {
        const hi = typedNumber(range.value);
        const valid = hi > 0 && hi > (this.scale.mode === 'tolerance' ? this.scale.upper : 0);
        range.setAttribute('aria-invalid', String(!valid));
        if (!valid) return;
        this.scale = {
          ...this.scale,
          hi,
          lo:
            page.scale.mode === 'sequential'
              ? (page.scale.lo / page.scale.hi) * hi
              : page.scale.lo < 0
                ? -hi
                : Math.min(page.scale.lo, hi / 2),
        };
        this.recolour();
      },
    });
    const startStyles = page.names.map((_, which) => (encloses(this.data, which) ? 'ghost' : 'solid'));
    startStyles.forEach((style, which) => this.view.setStyle(which, style as 'solid' | 'ghost'));
    const styles: [string, string][] = [
      ['solid', 'Solid'],
      ['ghost', 'Transparent'],
      ['hidden', 'Hidden'],
    ];
    byId('form').append(
      choice('mode', 'Colours', modes, page.scale.mode, (mode) => {
        this.scale = { ...this.scale, mode: mode as Mode };
        this.recolour();
      }),
      make(
        'div',
        { class: 'choice' },
        make('label', { for: 'range' }, 'Colours up to'),
        make('span', { class: 'field' }, range, page.units),
      ),
      ...page.names
        .map((_, which) => nameOf(this.data, which))
        .map((name, which) =>
          choice(`style${which}`, name, styles, startStyles[which], (style) =>
            this.view.setStyle(which, style as 'solid' | 'ghost' | 'hidden'),
          ),
        ),
      choice(
        'speed',
        'Speed',
        kSpeeds.map(([name, n]) => [String(n), name]),
        '30',
        (speed) => {
          this.perSecond = Number(speed);
          if (!this.playing) return;
          this.toggle();
          this.toggle();
        },
      ),
      ...(this.worst
        ? [
            make(
              'button',
              { type: 'button', id: 'to-worst', click: () => this.showWorst() },
              `Show the ${this.worst.isLeast ? 'least' : 'largest'} distance`,
            ),
          ]
        : []),
      make('button', { type: 'button', id: 'reset', click: () => this.lookAtAll() }, 'Look at all frames'),
    );
    byId('form').addEventListener('submit', (event) => event.preventDefault());
  }

  /// The distances of a body that are shown; for tests.
  distances(which: number): number[] {
    const values = new Float32Array(this.data.bodies[which].vertices);
    distancesOf(this.data, which, this.frame, values);
    return Array.from(values);
  }

  positions(which: number): number[] {
    const values = new Float32Array(3 * this.data.bodies[which].vertices);
    placeFrame(this.data, which, this.frame, [0, 0, 0], 1, values);
    return Array.from(values);
  }

  get shown(): number {
    return this.data.page.added[this.data.page.shown[this.frame]];
  }
}

/// The files of a body, without their folders.
function nameOf(data: PlayerData, which: number): string {
  const files = data.page.names[which]
    .split('+')
    .map((file) => file.split(/[\\/]/).filter(Boolean).pop() ?? file);
  return files.join('+');
}

function describe(data: PlayerData): void {
  const { added, shown, stride, bodies } = data.page;
  const [o1, o2] = [nameOf(data, 0), nameOf(data, 1)];
  byId('title').textContent = document.title = `${o1} and ${o2} over time`;
  const coloured = bodies[1].coloured
    ? 'each coloured by its distance to the other'
    : `${o1} coloured by its distance to ${o2}`;
  const thinned = stride > 1 ? `, of which ${count(shown.length)}, one of ${stride}, are in this page` : '';
  byId('sentence').textContent =
    `${count(added.length)} frames${thinned}, numbered ${added[0]} to ${added[added.length - 1]}; ${coloured}, with one scale for all frames. ` +
    'Colours are those of vertices, between which they are interpolated.';
}

void openPage('sdmPlayer', 'bodies', 'Is WebGL 2 on in this browser?', async () => {
  const data = await readPlayer();
  describe(data);
  showMade(
    [0, 1].map((which) => ({ file: nameOf(data, which), xxh3: data.page.xxh3?.[which] })),
    data.page,
  );
  return new Player(data);
});
