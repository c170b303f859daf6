// The form of the page: sliders and choices, and the state that they set.
import type { AreaByValue } from './area_by_value';
import { byId, make } from './dom';
import { check, select } from './fields';
import type { Report, Vec } from './page_data';
import { makeScaleControls } from './scale_controls';
import { makeSectionControls } from './section_controls';
import { kSteps } from './slider';
import { startOf, type State } from './state';
import { canJudge, limitsOf } from './verdict';

/// Fills the form, as it was `saved` if it was. `onChange` is called after each change; `look` with the name of a side, none
/// for the view that the page opened with.
export function makeControls(
  report: Report,
  area: AreaByValue,
  hasGhost: boolean,
  hasCoverage: boolean,
  ghostShown: boolean,
  isCloud: boolean,
  byGroup: boolean, // triangles have limits by their groups
  box: [Vec, Vec], // in the units of the files
  saved: State | null,
  onChange: (state: State) => void,
  look: (side?: string) => void,
): State {
  const unit = report.units ?? '';
  const start = () => startOf(report, area, ghostShown, byGroup);
  let state = start();
  const changed = () => {
    scale.allowBands();
    onChange(state);
  };
  const scale = makeScaleControls(report, area, byGroup, () => state.scale, changed);
  const section = makeSectionControls(box, unit, () => state.section, changed);
  const [ghostRow, ghostBox] = check('ghost', 'Show the reference as a ghost', ghostShown, (value) => {
    state.ghost = value;
    changed();
  });
  const [coverageRow, coverageBox] = check(
    'coverage',
    'Show where the reference was measured, without the part',
    false,
    (value) => {
      state.coverage = value;
      scale.enable(!state.coverage); // the picture of coverage has no colours of distances
      changed();
    },
  );
  const widthRange = make('input', {
    type: 'range',
    id: 'width',
    min: 0,
    max: kSteps,
    value: kSteps / 2,
    input: () => {
      state.width = 4 ** (Number(widthRange.value) / (kSteps / 2) - 1);
      changed();
    },
  });
  const widthRow = make(
    'div',
    { class: 'slider' },
    make('label', { for: 'width' }, 'Size of points'),
    widthRange,
  );
  const [viewRow, viewSelect] = select(
    'side',
    'View from',
    [
      ['', 'Choose…'],
      ['corner', 'Corner'],
      ['front', 'Front'],
      ['back', 'Back'],
      ['left', 'Left'],
      ['right', 'Right'],
      ['top', 'Top'],
      ['bottom', 'Bottom'],
    ],
    '',
    (value) => {
      if (value) look(value);
      viewSelect.value = '';
    },
  );
  const showState = () => {
    ghostBox.checked = state.ghost;
    coverageBox.checked = state.coverage;
    widthRange.value = String((kSteps / 2) * (1 + Math.log(state.width) / Math.log(4)));
    section.show();
    scale.show();
    scale.enable(!state.coverage);
  };
  const resetButton = make(
    'button',
    {
      type: 'button',
      id: 'reset',
      click: () => {
        state = start();
        showState();
        changed();
        look();
      },
    },
    'Reset',
  );

  byId('form').replaceChildren(
    ...scale.colours,
    ...(limitsOf(report) || canJudge(report)
      ? [...scale.limits, make('p', { id: 'what-if', role: 'status', 'aria-live': 'polite' })]
      : []),
    ...(report.group_tolerances
      ? [
          make(
            'p',
            { id: 'table-limits', class: 'hint' },
            `This tolerance is for the whole part. The groups keep the limits of their table${byGroup ? '' : ', which the colours do not show'}.`,
          ),
        ]
      : []),
    viewRow,
    ...section.rows,
    ...(isCloud ? [widthRow] : []),
    ...(hasGhost ? [ghostRow] : []),
    ...(hasCoverage ? [coverageRow] : []),
    resetButton,
  );
  byId('form').onsubmit = (event) => event.preventDefault(); // one listener, although a form may be made again
  if (saved) state = saved;
  showState();
  return state;
}
