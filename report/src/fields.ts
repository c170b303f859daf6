// Fields of forms, with their labels.
import { make } from './dom';

/// A choice of one of several options, by their keys; its row and the element.
export function select(
  id: string,
  label: string,
  options: [key: string, name: string][],
  value: string,
  set: (value: string) => void,
): [row: HTMLElement, element: HTMLSelectElement] {
  const element = make('select', { id, change: () => set(element.value) });
  for (const [key, name] of options)
    element.append(make('option', { value: key, selected: key === value }, name));
  return [make('div', { class: 'choice' }, make('label', { for: id }, label), element), element];
}

/// A checkbox; its row and the element.
export function check(
  id: string,
  label: string,
  value: boolean,
  set: (value: boolean) => void,
): [row: HTMLElement, element: HTMLInputElement] {
  const element = make('input', { type: 'checkbox', id, change: () => set(element.checked) });
  element.checked = value;
  return [make('div', { class: 'check' }, element, make('label', { for: id }, label)), element];
}
