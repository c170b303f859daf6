// The colours and the limits of the form.
import { kShorterSide } from 'sdm-rules';
import { kViridisInWords, type Mode, type Scale } from './color_scale';
import { select } from './fields';
import type { AreaByValue } from './area_by_value';
import type { Report } from './page_data';
import { Slider } from './slider';
import { isLimited, limitsOf, whatIf } from './verdict';
import { isSigned } from './words';

/// What the sliders ask has no answer.
function showNoLimits(report: Report): void {
  const none = { lower: -Infinity, upper: Infinity };
  document.getElementById('what-if')?.replaceChildren(whatIf(report, none, 0)[0]);
}

export interface ScaleControls {
  colours: HTMLElement[];
  limits: HTMLElement[];
  show(): void;
  enable(enabled: boolean): void;
  allowBands(): void;
}

/// `byGroup`: triangles have limits by their groups. `changed` is called after each change of the scale.
export function makeScaleControls(
  report: Report,
  area: AreaByValue,
  byGroup: boolean,
  scale: () => Scale,
  changed: () => void,
): ScaleControls {
  const unit = report.units ?? '';
  const signs = isSigned(report);
  const [least, most] = [
    report.extremes?.min?.distance ?? area.lo,
    report.extremes?.max?.distance ?? area.hi,
  ];
  const largest = Math.max(Math.abs(least), Math.abs(most)) || 1;
  const limits = limitsOf(report);
  const { mode: startMode, lo, hi } = scale();
  const top =
    1.2 * Math.max(largest, ...[lo, hi, scale().upper, scale().lower].filter(Number.isFinite).map(Math.abs));
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
  const reach = () => Math.max(Math.abs(scale().lo), Math.abs(scale().hi));
  /// The range up to `x`: on both sides, or of a sequential scale the shorter one as far as it was, relative to the longer one.
  const setReach = (x: number) => {
    const of = scale();
    const shorter = Math.min(kShorterSide, Math.max(0, Math.min(-of.lo, of.hi)) / reach());
    if (of.mode !== 'sequential') [of.lo, of.hi] = [signs || of.mode === 'diverging' ? -x : 0, x];
    else if (of.hi >= -of.lo) [of.lo, of.hi] = [-shorter * x, x];
    else [of.lo, of.hi] = [-x, shorter * x];
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
      value: scale().lo,
      ...linear,
      isValid: (x) => x < scale().hi && Number.isFinite(x),
      set: (x) => {
        scale().lo = x;
        changed();
      },
    }),
    hi: new Slider({
      id: 'range-hi',
      label: 'Colours to',
      unit,
      value: scale().hi,
      ...linear,
      isValid: (x) => x > scale().lo && Number.isFinite(x),
      set: (x) => {
        scale().hi = x;
        changed();
      },
    }),
    tolerance: new Slider({
      id: 'tolerance',
      label: signs ? 'Tolerance ±' : 'Tolerance',
      unit,
      value: scale().upper,
      ...cubic,
      isValid: (x) => Number.isFinite(x) && x >= 0,
      set: (x) => {
        scale().upper = x;
        scale().lower = -x;
        changed();
      },
      unset: unset(() => {
        scale().upper = Infinity;
        scale().lower = -Infinity;
      }),
    }),
    lower: new Slider({
      id: 'tolerance-lower',
      label: 'Lower limit',
      unit,
      value: scale().lower,
      ...bothSides,
      isValid: (x) => x <= scale().upper,
      set: (x) => {
        scale().lower = x;
        changed();
      },
      unset: Number.isFinite(limits?.lower)
        ? () => showNoLimits(report)
        : () => {
            scale().lower = -Infinity;
            changed();
          },
    }),
    upper: new Slider({
      id: 'tolerance-upper',
      label: 'Upper limit',
      unit,
      value: scale().upper,
      ...bothSides,
      isValid: (x) => x >= scale().lower,
      set: (x) => {
        scale().upper = x;
        changed();
      },
      unset: Number.isFinite(limits?.upper)
        ? () => showNoLimits(report)
        : () => {
            scale().upper = Infinity;
            changed();
          },
    }),
  };
  const oneTolerance = limits ? limits.lower === -limits.upper : !report.thickness;

  const showSliders = () => {
    const { mode } = scale();
    const symmetric = mode === 'diverging' || mode === 'tolerance' || mode === 'sequential';
    sliders.reach.element.hidden = !symmetric || (byGroup && mode === 'tolerance');
    sliders.lo.element.hidden = sliders.hi.element.hidden = symmetric;
    sliders.reach.show(reach());
    sliders.reach.element.querySelector('label')!.textContent =
      signs && mode !== 'sequential' ? 'Colours up to ±' : 'Colours up to';
    sliders.lo.show(scale().lo);
    sliders.hi.show(scale().hi);
  };
  const modes: [string, string][] = [
    ['tolerance', byGroup ? 'Tolerance bands of each group' : 'Tolerance bands'],
    ['diverging', 'Blue – white – red, about zero'],
    ['sequential', 'From zero, the other side in red'],
    ['viridis', kViridisInWords],
  ];
  if (startMode === 'paper2006') modes.push(['paper2006', 'Red – yellow – green']);
  const [modeRow, modeSelect] = select('mode', 'Colours', modes, startMode, (value) => {
    scale().mode = value as Mode;
    if (value === 'diverging') {
      const x = reach();
      [scale().lo, scale().hi] = [-x, x];
    }
    if (value === 'tolerance') {
      const { lower, upper } = scale();
      scale().hi = Math.max(reach(), Number.isFinite(upper) ? 2 * upper : 0);
      scale().lo = signs ? Math.min(-reach(), Number.isFinite(lower) ? 2 * lower : 0) : 0;
    }
    if (value === 'sequential') {
      const up = (typeof report.distance?.p50 === 'number' ? report.distance.p50 : most) >= 0;
      const x = reach();
      [scale().lo, scale().hi] = up
        ? [-0.5 * Math.min(x, Math.max(0, -least)), x]
        : [-x, 0.5 * Math.min(x, Math.max(0, most))];
    }
    if (value === 'viridis') {
      scale().lo = Math.max(least, -reach());
      scale().hi = Math.min(most, reach());
    }
    if (!(scale().lo < scale().hi)) [scale().lo, scale().hi] = [lo, hi];
    showSliders();
    changed();
  });
  // Bands need limits.
  const allowBands = () => {
    const allowed = isLimited(scale()) || byGroup;
    modeSelect.options[0].disabled = !allowed;
    if (allowed || scale().mode !== 'tolerance') return;
    modeSelect.value = 'diverging';
    modeSelect.dispatchEvent(new Event('change'));
  };
  return {
    colours: [modeRow, sliders.reach.element, sliders.lo.element, sliders.hi.element],
    limits: (oneTolerance ? [sliders.tolerance] : [sliders.lower, sliders.upper]).map(
      ({ element }) => element,
    ),
    show: () => {
      modeSelect.value = scale().mode;
      for (const slider of [sliders.tolerance, sliders.upper]) slider.show(scale().upper);
      sliders.lower.show(scale().lower);
      showSliders();
      allowBands();
    },
    enable: (enabled) => {
      modeSelect.disabled = !enabled;
      for (const slider of Object.values(sliders)) slider.enable(enabled);
    },
    allowBands,
  };
}
