// Puts the pieces of player.html together.
import type { Mode, Scale } from './color_scale';
import { byId, make } from './dom';
import { drawLegend } from './legend';
import { count } from './numbers';
import { openPage } from './open_page';
import { Chart } from './player_charts';
import { distancesOf, placeFrame, PlayerData, readPlayer } from './player_data';
import { encloses, PlayerView } from './player_view';

const kSpeeds: [string, number][] = [
  ['5 a second', 5],
  ['15 a second', 15],
  ['30 a second', 30],
  ['60 a second', 60],
];

class Player {
  private frame = 0; // among those in the page
  private playing = false;
  private perSecond = 30;
  private scale: Scale;
  private readonly time = byId('time') as HTMLInputElement;
  private readonly play = byId('play') as HTMLButtonElement;
  private readonly charts: Chart[];

  constructor(private readonly data: PlayerData, private readonly view: PlayerView) {
    const { page } = data;
    this.scale = { ...page.scale };
    this.time.max = String(page.shown.length - 1);
    this.time.addEventListener('input', () => this.show(Number(this.time.value)));
    this.play.addEventListener('click', () => this.toggle());
    document.addEventListener('keydown', (event) => this.key(event));
    const charts = byId('charts');
    const pick = (place: number) => this.show(this.nearest(place));
    this.charts = page.panels.map((panel) => new Chart(panel, page.added, charts.clientWidth, pick));
    charts.replaceChildren(...this.charts.map(({ element }) => element));
    this.makeForm();
    this.recolour();
    this.show(0);
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
    byId('frame').textContent = `frame ${page.added[place]} of ${page.added[page.added.length - 1]}`;
    for (const chart of this.charts) chart.show(place);
  }

  private toggle(): void {
    this.playing = !this.playing;
    this.play.textContent = this.playing ? 'Stop' : 'Play';
    this.play.setAttribute('aria-pressed', String(this.playing));
    if (!this.playing) return;
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
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|BUTTON)$/.test(target.tagName)) return;
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
    this.view.setScale(this.scale, page.colors);
    const missing = bodies.some(({ distances }) => distances?.includes(65535));
    drawLegend(this.scale, page.colors, 'distance', page.units, missing);
  }

  private makeForm(): void {
    const { page } = this.data;
    const choice = (id: string, label: string, options: [string, string][], value: string, set: (value: string) => void) => {
      const select = make('select', { id, change: () => set(select.value) });
      for (const [key, name] of options) select.append(make('option', { value: key, selected: key === value }, name));
      return make('div', { class: 'choice' }, make('label', { for: id }, label), select);
    };
    const modes: [Mode, string][] = [
      ['viridis', 'Viridis'],
      ['sequential', 'From zero, the other side in red'],
      ['diverging', 'Blue, white, red'],
      ['paper2006', 'Red to green'],
    ];
    if (page.scale.mode === 'tolerance') modes.unshift(['tolerance', 'Tolerance bands']);
    const range = make('input', {
      type: 'number',
      id: 'range',
      step: 'any',
      value: Number(this.scale.hi.toPrecision(4)),
      input: () => {
        const hi = Number(range.value);
        const valid = range.value !== '' && hi > 0 && hi > (this.scale.mode === 'tolerance' ? this.scale.upper : 0);
        range.setAttribute('aria-invalid', String(!valid));
        if (!valid) return;
        this.scale = { ...this.scale, hi, lo: page.scale.mode === 'sequential' ? (page.scale.lo / page.scale.hi) * hi : page.scale.lo < 0 ? -hi : Math.min(page.scale.lo, hi / 2) };
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
      make('div', { class: 'choice' }, make('label', { for: 'range' }, 'Colours up to'), make('span', { class: 'field' }, range, page.units)),
      ...page.names.map((name, which) =>
        choice(`style${which}`, name.split('/').pop()!, styles, startStyles[which], (style) =>
          this.view.setStyle(which, style as 'solid' | 'ghost' | 'hidden'),
        ),
      ),
      choice('speed', 'Frames', kSpeeds.map(([name, n]) => [String(n), name]), '30', (speed) => {
        this.perSecond = Number(speed);
        if (this.playing) this.toggle(), this.toggle();
      }),
      make('button', { type: 'button', id: 'reset', click: () => this.view.look('corner') }, 'Look at all of it'),
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

function describe(data: PlayerData): void {
  const { names, added, shown, stride, bodies } = data.page;
  const [o1, o2] = names.map((name) => name.split('/').pop());
  byId('title').textContent = document.title = `${o1} and ${o2} over time`;
  const coloured = bodies[1].coloured ? 'each coloured by its distance to the other' : `${o1} coloured by its distance to ${o2}`;
  const thinned = stride > 1 ? `, of which ${count(shown.length)}, one of ${stride}, are in this page` : '';
  byId('sentence').textContent =
    `${count(added.length)} frames${thinned}; ${coloured}, with one scale for all frames. ` +
    'Colours are those of vertices, between which they are interpolated.';
}

void openPage('sdmPlayer', 'bodies', 'Is WebGL 2 on in this browser?', async () => {
  const data = await readPlayer();
  describe(data);
  return new Player(data, new PlayerView(byId('view'), data));
});
