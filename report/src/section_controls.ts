// Where the form has the part cut.
import { make } from './dom';
import { check, select } from './fields';
import type { Vec } from './page_data';
import { Slider } from './slider';
import type { State } from './state';

/// `box`: in the units of the files.
export function makeSectionControls(
  box: [Vec, Vec],
  unit: string,
  section: () => State['section'],
  changed: () => void,
): { rows: HTMLElement[]; show: () => void } {
  const [sectionRow, sectionSelect] = select(
    'section',
    'Section',
    [
      ['', 'None'],
      ['0', 'Across x'],
      ['1', 'Across y'],
      ['2', 'Across z'],
    ],
    '',
    (value) => {
      section().axis = value === '' ? null : (Number(value) as 0 | 1 | 2);
      sectionDetails.hidden = value === '';
      sectionAt.show(sectionValue());
      changed();
    },
  );
  // Along the box, of which the ends are excluded: a plane there cuts nothing.
  const along = () => [0, 1].map((end) => box[end][section().axis ?? 0]);
  const sectionValue = () => along()[0] + section().at * (along()[1] - along()[0]);
  const sectionAt = new Slider({
    id: 'section-at',
    label: 'Section at',
    unit,
    value: sectionValue(),
    isValid: (x) => x >= along()[0] && x <= along()[1],
    toValue: (t) => along()[0] + t * (along()[1] - along()[0]),
    toSlider: (x) => (along()[1] > along()[0] ? (x - along()[0]) / (along()[1] - along()[0]) : 0.5),
    round: (x) =>
      Number(x.toFixed(Math.min(15, Math.max(0, 4 - Math.floor(Math.log10(along()[1] - along()[0] || 1)))))),
    set: (x) => {
      section().at = along()[1] > along()[0] ? (x - along()[0]) / (along()[1] - along()[0]) : 0.5;
      changed();
    },
  });
  const [flipRow, flipBox] = check('section-flip', 'Other side', false, (value) => {
    section().flipped = value;
    changed();
  });
  const sectionDetails = make(
    'div',
    { hidden: true },
    sectionAt.element,
    flipRow,
    make('p', { id: 'section-words', class: 'hint' }),
  );
  return {
    rows: [sectionRow, sectionDetails],
    show: () => {
      const { axis, flipped } = section();
      sectionSelect.value = axis === null ? '' : String(axis);
      sectionAt.show(sectionValue());
      flipBox.checked = flipped;
      sectionDetails.hidden = axis === null;
    },
  };
}
