// The controls of the live page: what is compared, and how it moves.
import { byId, make } from '../src/dom';
import { select } from '../src/fields';
import { fileButton } from './files';
import { kScenes } from './scenes';
import type { Session } from './session';
import type { Handles } from './view';

export interface Actions {
  openScene: (name: string) => void;
  openFiles: (files: File[], which: 0 | 1 | null) => void;
  swap: () => void;
  convert: () => void; ///< the part, to the unit of the reference
  cancel: () => void; ///< what is being loaded
  setResolution: (resolution: number) => void;
  setFacing: (degrees: number | null) => void; ///< distances are to faces that face the same way
  setUnits: (units: string) => void;
  setHandles: (handles: Handles) => void;
  resetMotion: () => void;
  togglePlay: () => void;
}

export const kResolutions = [256, 512, 1024, 2048];
const kFacing: [string, string][] = [
  ['', 'any face'],
  ...[90, 60, 30].map((degrees): [string, string] => [String(degrees), `faces within ${degrees}°`]),
];

/// Adds the controls to the page, once.
export function addPanel(scene: string, resolution: number, actions: Actions): void {
  const button = (id: string, label: string, click: () => void) =>
    make('button', { type: 'button', id, click }, label);
  const scenes = Object.entries(kScenes).map(([name, { title }]): [string, string] => [name, title]);
  const units = make('input', {
    type: 'text',
    id: 'units',
    size: 4,
    maxlength: 12,
    autocomplete: 'off',
    change: () => actions.setUnits(units.value.trim()),
  });
  const cancel = button('cancel', 'Cancel', actions.cancel);
  const convert = button('convert', '', actions.convert);
  cancel.hidden = convert.hidden = true;
  const section = make(
    'section',
    { id: 'compare', 'aria-labelledby': 'compare-title' },
    make('h2', { id: 'compare-title', class: 'hidden' }, 'What to compare'),
    make(
      'div',
      { class: 'row' },
      select('scene', 'Pair', [...scenes, ['files', 'Your files…']], scene, (name) => {
        if (name !== 'files') return actions.openScene(name);
        (byId('scene') as HTMLSelectElement).value = byId('scene').dataset.shown ?? scene; // until there are files
        byId('open-both').click();
      })[0],
      fileButton('open-both', 'Open two files…', true, (files) => actions.openFiles(files, null)),
      fileButton('open-part', 'Open part…', false, (files) => actions.openFiles(files, 0)),
      fileButton('open-reference', 'Open reference…', false, (files) => actions.openFiles(files, 1)),
      button('swap', 'Swap', actions.swap),
      select(
        'resolution',
        'Map',
        kResolutions.map((n) => [String(n), `${n} × ${n}`]),
        String(resolution),
        (n) => actions.setResolution(Number(n)),
      )[0],
      select('facing', 'Closest of', kFacing, '', (degrees) =>
        actions.setFacing(degrees === '' ? null : Number(degrees)),
      )[0],
      make('div', { class: 'field-of' }, make('label', { for: 'units' }, 'Unit'), units),
    ),
    make(
      'div',
      { id: 'said' },
      make(
        'p',
        { class: 'hint' },
        'Or drop two files here: STL, PLY, OBJ, OFF, 3DS or GLB, the part and the reference. They stay on this computer: the page cannot send anything.',
      ),
      make(
        'div',
        { class: 'row' },
        make('p', { id: 'status', role: 'status', 'aria-live': 'polite' }),
        cancel,
        convert,
      ),
    ),
  );
  document.querySelector('main')!.prepend(section);

  const handle = (value: Handles, label: string) => {
    const input = make('input', {
      type: 'radio',
      name: 'handles',
      id: `handles-${value}`,
      value,
      change: () => actions.setHandles(value),
    });
    input.checked = value === 'none';
    return make('span', { class: 'segment' }, input, make('label', { for: `handles-${value}` }, label));
  };
  // Above the picture, so that a window of 800 pixels shows it whole.
  byId('view').before(
    make(
      'div',
      { id: 'transport' },
      make('button', { type: 'button', id: 'play', click: actions.togglePlay }, 'Play'),
      make(
        'fieldset',
        { id: 'handles' },
        make('legend', {}, 'Reference'),
        handle('none', 'Fixed'),
        handle('move', 'Move'),
        handle('turn', 'Turn'),
      ),
      button('reset-motion', 'Put back', actions.resetMotion),
      make(
        'dl',
        { id: 'live-values' },
        make('div', {}, make('dt', {}, 'Separation'), make('dd', { id: 'separation' }, '–')),
        make('div', {}, make('dt', {}, 'Mean'), make('dd', { id: 'live-mean' }, '–')),
        make('div', {}, make('dt', {}, 'Computed'), make('dd', { id: 'rate' }, '–')),
      ),
    ),
  );
  byId('view').after(make('p', { id: 'spoken', class: 'hidden', role: 'status', 'aria-live': 'polite' }));
  byId('keys').append(
    ' ',
    make(
      'span',
      { class: 'by-mouse' },
      'Shift with arrows, Page up and Page down moves the reference, Shift with < and > turns it; P plays.',
    ),
    make('span', { class: 'by-touch' }, 'With Move or Turn, one finger drags the handles of the reference.'),
  );
}

export function showPlaying(playing: boolean): void {
  byId('play').textContent = playing ? 'Stop' : 'Play';
}

/// The choices of what is shown.
export function showChoices({ choice, units, resolution }: Session, wanted = resolution): void {
  const set = (id: string, value: string) =>
    ((byId(id) as HTMLSelectElement | HTMLInputElement).value = value);
  if (choice) {
    set('scene', choice.name);
    byId('scene').dataset.shown = choice.name;
  }
  set('units', units);
  set('resolution', String(wanted));
}

/// A factor between two units as text.
export function timesText(factor: number): string {
  const [sign, times] = factor > 1 ? ['×', factor] : ['÷', 1 / factor];
  return `${sign} ${Number(times.toPrecision(6))}`;
}

/// Offers to convert the part by a factor; null: it has the unit of the reference.
export function showFactor(factor: number | null): void {
  byId('convert').hidden = factor === null;
  if (factor !== null) byId('convert').textContent = `Scale the part ${timesText(factor)}`;
}

/// What is not of what is in the worker now is dimmed, and cannot be saved.
export function showBusy({ loading, moving }: Session): void {
  document.body.classList.toggle('stale', loading || moving);
  document.body.setAttribute('aria-busy', String(loading));
  for (const id of ['play', 'reset-motion']) (byId(id) as HTMLButtonElement).disabled = loading;
  for (const button of document.querySelectorAll<HTMLButtonElement>('#controls button[id^=save-]'))
    button.disabled = loading || moving;
}
