// Elements, made and found.

type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

/// An element with attributes and content. Attributes that are functions are listeners for the event of that name.
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...content: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false) element.setAttribute(name, String(value));
  }
  element.append(...content);
  return element;
}

export function makeSvg(tag: string, attributes: Record<string, string | number>, ...content: (Node | string)[]): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...content);
  return element;
}

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}

export function table(head: string[], rows: (Node | string)[][], caption: string): HTMLElement {
  return make(
    'div',
    { class: 'scroll' },
    make(
      'table',
      {},
      make('caption', { class: 'hidden' }, caption),
      make('thead', {}, make('tr', {}, ...head.map((text) => make('th', { scope: 'col' }, text)))),
      make(
        'tbody',
        {},
        ...rows.map(([first, ...rest]) =>
          make('tr', {}, make('th', { scope: 'row' }, first), ...rest.map((cell) => make('td', {}, cell))),
        ),
      ),
    ),
  );
}
