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

export function makeSvg(
  tag: string,
  attributes: Record<string, string | number>,
  ...content: (Node | string)[]
): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...content);
  return element;
}

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}

/// A table; of more rows than `most`, the first ones, with a button that shows all of them.
export function table(
  head: string[],
  rows: (Node | string)[][],
  caption: string,
  most = Infinity,
): HTMLElement {
  const made = rows.map(([first, ...rest]) =>
    make('tr', {}, make('th', { scope: 'row' }, first), ...rest.map((cell) => make('td', {}, cell))),
  );
  const hidden = made.length > most + 1 ? made.slice(most) : [];
  for (const row of hidden) row.hidden = true;
  const button = make(
    'button',
    {
      type: 'button',
      class: 'show-all',
      click: () => {
        for (const row of hidden) row.hidden = false;
        button.remove();
      },
    },
    `Show all ${made.length} rows`,
  );
  return make(
    'div',
    { class: 'scroll' },
    make(
      'table',
      {},
      make('caption', { class: 'hidden' }, caption),
      make('thead', {}, make('tr', {}, ...head.map((text) => make('th', { scope: 'col' }, text)))),
      make('tbody', {}, ...made),
    ),
    ...(hidden.length > 0 ? [button] : []),
  );
}
