// Sliders and choices, and the state that they set.
import { kViridisInWords, Mode, Scale } from './color_scale';
import { byId, make } from './dom';
import { check, select } from './fields';
import { text, typedNumber } from './numbers';
import type { AreaByValue } from './area_by_value';
import type { Report, Vec } from './page_data';
import { canJudge, isLimited, isSigned, limitsOf, whatIf } from './verdict';

export interface State {
  scale: Scale;
  section: { axis: 0 | 1 | 2 | null; at: number; flipped: boolean }; ///< at: 0 to 1 along the box
  ghost: boolean;
  group?: { kind: string; group: string } | null; ///< alone in colours
  coverage: boolean; ///< of the reference, in place of the part
  width: number; ///< of the points of a cloud, relative to the usual one
  logarithmic?: boolean; ///< the heights of the histogram
}

const kSteps = 1000;

interface SliderOptions {
  id: string;
  label: string;
  unit: string;
  value: number;
  toValue: (t: number) => number; ///< t from 0 to 1
  toSlider: (value: number) => number;
  isValid: (value: number) => boolean;
  set: (value: number) => void;
  round?: (value: number) => number; ///< of a value by the slider; default: to four digits
  unset?: () => void; ///< the field may be empty; it is, or holds what is no value
}

/// A slider and a field for the same number.
class Slider {
  readonly element: HTMLElement;
  private readonly range: HTMLInputElement;
  private readonly field: HTMLInputElement;

  constructor(private readonly options: SliderOptions) {
    const { id, label, unit } = options;
    this.range = make('input', {
      type: 'range',
      id,
      min: 0,
      max: kSteps,
      step: 1,
      input: () => this.changed(this.rounded(options.toValue(Number(this.range.value) / kSteps)), this.range),
    });
    this.field = make('input', {
      type: 'text',
      inputmode: 'decimal',
      autocomplete: 'off',
      'aria-label': `${label}${unit ? `, in ${unit}` : ''}`,
      input: () => this.changed(typedNumber(this.field.value), this.field),
    });
    this.element = make(
      'div',
      { class: 'slider' },
      make('label', { for: id }, label),
      this.range,
      make('span', { class: 'field' }, this.field, unit),
    );
    this.show(options.value);
  }

  // Fields show what a person would type.
  private rounded(value: number): number {
    return this.options.round ? this.options.round(value) : Number(value.toPrecision(4));
  }

  private changed(value: number, by: HTMLInputElement): void {
    const valid = this.options.isValid(value);
    const mayBeEmpty = this.options.unset !== undefined && by.value.trim() === '';
    this.field.setAttribute('aria-invalid', String(!valid && !mayBeEmpty));
    if (!valid) return void this.options.unset?.();
    this.show(value, by);
    this.options.set(value);
  }

  enable(enabled: boolean): void {
    this.range.disabled = this.field.disabled = !enabled;
  }

  show(value: number, except?: HTMLInputElement): void {
    if (except !== this.range) this.range.value = String(Math.round(kSteps * this.options.toSlider(value)));
    this.element.classList.toggle('unset', !Number.isFinite(value));
    if (!Number.isFinite(value)) {
      this.field.value = '';
      this.range.setAttribute('aria-valuetext', 'not set');
      return;
    }
    if (except !== this.field)
      this.field.value = String(
        this.options.round ? this.options.round(value) : Number(value.toPrecision(6)),
      );
    this.range.setAttribute('aria-valuetext', `${text(value)} ${this.options.unit}`);
  }
}

/// What the sliders ask has no answer.
function showNoLimits(report: Report): void {
  const none = { lower: -Infinity, upper: Infinity };
  document.getElementById('what-if')?.replaceChildren(whatIf(report, none, 0)[0]);
}

/// The settings that a page opens with; `byGroup`: triangles have limits by their groups.
export function startOf(report: Report, area: AreaByValue, ghostShown: boolean, byGroup = false): State {
  const [least, most] = [
    report.extremes?.min?.distance ?? area.lo,
    report.extremes?.max?.distance ?? area.hi,
  ];
  const largest = Math.max(Math.abs(least), Math.abs(most)) || 1;
  const [lo, hi] = report.colors?.range ?? [
    least < 0 ? -largest : least,
    Math.max(most, least + largest * 1e-6),
  ];
  return {
    scale: {
      mode: (byGroup && report.colors?.by_group !== false
        ? 'tolerance'
        : (report.colors?.map ?? (least < 0 && most > 0 ? 'diverging' : 'viridis'))) as Mode,
      lo,
      hi: hi > lo ? hi : lo + 1,
      ...(limitsOf(report) ?? { lower: -Infinity, upper: Infinity }),
      accuracy: report.accuracy ?? 0,
    },
    section: { axis: null, at: 0.5, flipped: false },
    ghost: ghostShown,
    coverage: false,
    width: 1,
  };
}

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
  const signs = isSigned(report);
  const [least, most] = [
    report.extremes?.min?.distance ?? area.lo,
    report.extremes?.max?.distance ?? area.hi,
  ];
  const largest = Math.max(Math.abs(least), Math.abs(most)) || 1;
  const limits = limitsOf(report);
  const start = () => startOf(report, area, ghostShown, byGroup);
  let state = start();
  const { mode: startMode, lo, hi } = state.scale;

  const changed = () => {
    allowBands();
    onChange(state);
  };
  const top =
    1.2 *
    Math.max(
      largest,
      ...[lo, hi, state.scale.upper, state.scale.lower].filter(Number.isFinite).map(Math.abs),
    );
  // Cubic, so that small numbers can be set although a single outlier is far away.
  const cubic = {
    toValue: (t: number) => top * t ** 3,
    toSlider: (x: number) => Math.cbrt(Math.min(1, Math.max(0, x / top))),
  };
  const [from, to] = [Math.min(least, lo), Math.max(most, hi)];
  const linear = {
    toValue: (t: number) => from + t * (to - from),
    toSlider: (x: number) => Math.min(1, Math.max(0, (x - from) / (to - from || 1))),
  };
  const bothSides = report.thickness
    ? cubic
    : {
        toValue: (t: number) => top * (2 * t - 1) ** 3,
        toSlider: (x: number) => (1 + Math.cbrt(Math.min(1, Math.max(-1, x / top)))) / 2,
      };
  const positive = (x: number) => Number.isFinite(x) && x > 0;
  const reach = () => Math.max(Math.abs(state.scale.lo), Math.abs(state.scale.hi));
  /// The range up to `x`: on both sides, or of a sequential scale the shorter one as far as it was, relative to the longer one.
  const setReach = (x: number) => {
    const { scale } = state;
    const shorter = Math.min(0.5, Math.max(0, Math.min(-scale.lo, scale.hi)) / reach());
    if (scale.mode !== 'sequential') [scale.lo, scale.hi] = [signs || scale.mode === 'diverging' ? -x : 0, x];
    else if (scale.hi >= -scale.lo) [scale.lo, scale.hi] = [-shorter * x, x];
    else [scale.lo, scale.hi] = [-x, shorter * x];
  };
  // Limits that were given stay those of the colours while the field has none.
  const unset = (take: () => void) => () => {
    if (limits) return showNoLimits(report);
    take();
    changed();
  };
  const sliders = {
    reach: new Slider({
      id: 'range',
      label: signs ? 'Colours up to ±' : 'Colours up to',
      unit,
      value: reach(),
      ...cubic,
      isValid: positive,
      set: (x) => {
        setReach(x);
        changed();
      },
    }),
    lo: new Slider({
      id: 'range-lo',
      label: 'Colours from',
      unit,
      value: state.scale.lo,
      ...linear,
      isValid: (x) => x < state.scale.hi && Number.isFinite(x),
      set: (x) => {
        state.scale.lo = x;
        changed();
      },
    }),
    hi: new Slider({
      id: 'range-hi',
      label: 'Colours to',
      unit,
      value: state.scale.hi,
      ...linear,
      isValid: (x) => x > state.scale.lo && Number.isFinite(x),
      set: (x) => {
        state.scale.hi = x;
        changed();
      },
    }),
    tolerance: new Slider({
      id: 'tolerance',
      label: signs ? 'Tolerance ±' : 'Tolerance',
      unit,
      value: state.scale.upper,
      ...cubic,
      isValid: (x) => Number.isFinite(x) && x >= 0,
      set: (x) => {
        state.scale.upper = x;
        state.scale.lower = -x;
        changed();
      },
      unset: unset(() => {
        state.scale.upper = Infinity;
        state.scale.lower = -Infinity;
      }),
    }),
    lower: new Slider({
      id: 'tolerance-lower',
      label: 'Lower limit',
      unit,
      value: state.scale.lower,
      ...bothSides,
      isValid: (x) => x <= state.scale.upper,
      set: (x) => {
        state.scale.lower = x;
        changed();
      },
      unset: Number.isFinite(limits?.lower)
        ? () => showNoLimits(report)
        : () => {
            state.scale.lower = -Infinity;
            changed();
          },
    }),
    upper: new Slider({
      id: 'tolerance-upper',
      label: 'Upper limit',
      unit,
      value: state.scale.upper,
      ...bothSides,
      isValid: (x) => x >= state.scale.lower,
      set: (x) => {
        state.scale.upper = x;
        changed();
      },
      unset: Number.isFinite(limits?.upper)
        ? () => showNoLimits(report)
        : () => {
            state.scale.upper = Infinity;
            changed();
          },
    }),
  };
  const oneTolerance = limits ? limits.lower === -limits.upper : !report.thickness;

  const showSliders = () => {
    const { mode } = state.scale;
    const symmetric = mode === 'diverging' || mode === 'tolerance' || mode === 'sequential';
    sliders.reach.element.hidden = !symmetric || (byGroup && mode === 'tolerance');
    sliders.lo.element.hidden = sliders.hi.element.hidden = symmetric;
    sliders.reach.show(reach());
    sliders.reach.element.querySelector('label')!.textContent =
      signs && mode !== 'sequential' ? 'Colours up to ±' : 'Colours up to';
    sliders.lo.show(state.scale.lo);
    sliders.hi.show(state.scale.hi);
  };
  const modes: [string, string][] = [
    ['tolerance', byGroup ? 'Tolerance bands of each group' : 'Tolerance bands'],
    ['diverging', 'Blue – white – red, about zero'],
    ['sequential', 'From zero, the other side in red'],
    ['viridis', kViridisInWords],
  ];
  if (startMode === 'paper2006') modes.push(['paper2006', 'Red – yellow – green']);
  const [modeRow, modeSelect] = select('mode', 'Colours', modes, startMode, (value) => {
    state.scale.mode = value as Mode;
    if (value === 'diverging') (state.scale.hi = reach()), (state.scale.lo = -state.scale.hi);
    if (value === 'tolerance') {
      const { lower, upper } = state.scale;
      state.scale.hi = Math.max(reach(), Number.isFinite(upper) ? 2 * upper : 0);
      state.scale.lo = signs ? Math.min(-reach(), Number.isFinite(lower) ? 2 * lower : 0) : 0;
    }
    if (value === 'sequential') {
      const up = (typeof report.distance?.p50 === 'number' ? report.distance.p50 : most) >= 0;
      const x = reach();
      [state.scale.lo, state.scale.hi] = up
        ? [-0.5 * Math.min(x, Math.max(0, -least)), x]
        : [-x, 0.5 * Math.min(x, Math.max(0, most))];
    }
    if (value === 'viridis')
      (state.scale.lo = Math.max(least, -reach())), (state.scale.hi = Math.min(most, reach()));
    if (!(state.scale.lo < state.scale.hi)) [state.scale.lo, state.scale.hi] = [lo, hi];
    showSliders();
    changed();
  });
  // Bands need limits.
  const allowBands = () => {
    const allowed = isLimited(state.scale) || byGroup;
    modeSelect.options[0].disabled = !allowed;
    if (allowed || state.scale.mode !== 'tolerance') return;
    modeSelect.value = 'diverging';
    modeSelect.dispatchEvent(new Event('change'));
  };
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
      state.section.axis = value === '' ? null : (Number(value) as 0 | 1 | 2);
      sectionDetails.hidden = value === '';
      sectionAt.show(sectionValue());
      changed();
    },
  );
  // Along the box, of which the ends are excluded: a plane there cuts nothing.
  const along = () => [0, 1].map((end) => box[end][state.section.axis ?? 0]);
  const sectionValue = () => along()[0] + state.section.at * (along()[1] - along()[0]);
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
      state.section.at = along()[1] > along()[0] ? (x - along()[0]) / (along()[1] - along()[0]) : 0.5;
      changed();
    },
  });
  const [flipRow, flipBox] = check('section-flip', 'Other side', false, (value) => {
    state.section.flipped = value;
    changed();
  });
  const sectionDetails = make(
    'div',
    { hidden: true },
    sectionAt.element,
    flipRow,
    make('p', { id: 'section-words', class: 'hint' }),
  );
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
      enableColours();
      changed();
    },
  );
  // The picture of coverage has no colours of distances.
  const enableColours = () => {
    modeSelect.disabled = state.coverage;
    for (const slider of Object.values(sliders)) slider.enable(!state.coverage);
  };
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
    const { scale, section, ghost, coverage, width } = state;
    modeSelect.value = scale.mode;
    sectionSelect.value = section.axis === null ? '' : String(section.axis);
    sectionAt.show(sectionValue());
    flipBox.checked = section.flipped;
    sectionDetails.hidden = section.axis === null;
    ghostBox.checked = ghost;
    coverageBox.checked = coverage;
    widthRange.value = String((kSteps / 2) * (1 + Math.log(width) / Math.log(4)));
    for (const slider of [sliders.tolerance, sliders.upper]) slider.show(scale.upper);
    sliders.lower.show(scale.lower);
    showSliders();
    allowBands();
    enableColours();
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
  const limitSliders = oneTolerance ? [sliders.tolerance] : [sliders.lower, sliders.upper];

  byId('form').replaceChildren(
    modeRow,
    sliders.reach.element,
    sliders.lo.element,
    sliders.hi.element,
    ...(limits || canJudge(report)
      ? [
          ...limitSliders.map(({ element }) => element),
          make('p', { id: 'what-if', role: 'status', 'aria-live': 'polite' }),
        ]
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
    sectionRow,
    sectionDetails,
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
