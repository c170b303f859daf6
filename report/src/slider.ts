// A slider and a field for the same number.
import { make } from './dom';
import { text, typedNumber } from './numbers';

export const kSteps = 1000;

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

export class Slider {
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
