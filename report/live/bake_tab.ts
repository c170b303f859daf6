// The tab “Bake”: what of the reference is shown on the part, and which of its points belong to a texel.
import type { MatchCounts, MatchMethod, MatchOptions } from 'sdm';
import { byId, make } from '../src/dom';
import { select } from '../src/fields';
import { count, percent, typedNumber } from '../src/numbers';
import { capital } from '../src/words';
import type { Paint } from './subject';
import { addTabs } from './tabs';

/// What the tab sets.
export interface BakeChoices {
  options: MatchOptions;
  kind: Paint['kind'] | null; ///< that is shown in place of the distances
}

const kShown: [string, string][] = [
  ['', 'Distances'],
  ['colors', 'Colours of the reference'],
  ['normals', 'Normals of the reference'],
];
const kMethods: [MatchMethod, string][] = [
  ['facing', 'Closest facing the same way'],
  ['closest', 'Closest point'],
  ['ray', 'Along the normal'],
];

const sentence = (note: string): string => `${capital(note)}.`;

/// The rows of a field for a number greater than 0; empty: none.
function numberField(
  id: string,
  label: string,
  value: string,
  set: (value: number | null) => void,
): HTMLElement {
  const input = make('input', {
    type: 'text',
    inputmode: 'decimal',
    autocomplete: 'off',
    id,
    value,
    change: () => {
      const number = typedNumber(input.value);
      const isEmpty = input.value.trim() === '';
      const valid = isEmpty || number > 0;
      input.setAttribute('aria-invalid', String(!valid));
      if (valid) set(isEmpty ? null : number);
    },
  });
  return make('div', { class: 'field-of' }, make('label', { for: id }, label), input);
}

export class BakeTab {
  /// `changed`: after each choice; `save`: the model with its textures.
  constructor(
    choices: () => BakeChoices,
    changed: () => void,
    save: () => Promise<void>,
    fault: (error: unknown) => void,
  ) {
    const set = (options: Partial<MatchOptions>) => {
      Object.assign(choices().options, options);
      changed();
    };
    const cage = numberField('bake-cage', 'Within, along the normal', '', (x) =>
      set({ cage: x ?? Infinity }),
    );
    const facing = numberField('bake-facing', 'Normals differ by less than, in °', '90', (x) =>
      set({ facing: Math.min(180, x ?? 90) }),
    );
    const showFields = (method: string) =>
      ([cage.hidden, facing.hidden] = [method !== 'ray', method === 'closest']);
    const [shown] = select('bake-shown', 'Show', kShown, '', (kind) => {
      choices().kind = kind === '' ? null : (kind as Paint['kind']);
      changed();
    });
    const [method] = select('bake-method', 'Point of a texel', kMethods, 'facing', (value) => {
      showFields(value);
      set({ method: value as MatchMethod });
    });
    showFields('facing');
    const panel = make(
      'div',
      { id: 'bake', class: 'form' },
      shown,
      method,
      facing,
      cage,
      make('p', { id: 'bake-words', role: 'status', 'aria-live': 'polite' }),
      make(
        'button',
        { type: 'button', id: 'save-baked', click: () => void save().catch(fault) },
        'Save baked model (GLB)',
      ),
    );
    byId('form').after(panel);
    byId('controls-title').classList.add('hidden');
    addTabs('Controls', [
      ['Display', byId('form')],
      ['Bake', panel],
    ]);
  }

  /// The reference has no colours.
  showMissing(name: string, notes: string[]): void {
    byId('bake-words').textContent = [
      `${name} has neither colours nor materials to bake. Its normals can be baked.`,
      ...notes.map(sentence),
    ].join(' ');
  }

  /// How many texels have a point; `shown`: something is baked, or will be at rest.
  showCounts(counts: MatchCounts | null, shown: boolean, notes: string[] = []): void {
    document.body.classList.toggle('painted', shown && counts !== null);
    const words = byId('bake-words');
    if (!counts)
      return void words.replaceChildren(
        shown
          ? 'Baked at rest.'
          : 'Colours or normals of the reference as a texture of the part, in place of the distances.',
      );
    const { tooFar, facingAway } = counts;
    const all = Object.values(counts).reduce((sum, n) => sum + n, 0);
    const without = tooFar + facingAway;
    const share = percent(without / Math.max(1, all));
    words.replaceChildren(
      without === 0
        ? `All ${count(all)} texels of the part have a point of the reference.`
        : `${count(without)} of ${count(all)} texels (${share}) have no point of the reference: ` +
            [
              tooFar && `${count(tooFar)} are too far away`,
              facingAway && `nothing faces ${count(facingAway)}`,
            ]
              .filter(Boolean)
              .join(', ') +
            '. They are grey here, and filled in the saved texture.',
      ...notes.map((note) => ` ${sentence(note)}`),
    );
  }
}
