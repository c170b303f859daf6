// Tabs: of several panels one is shown.
import { make } from '../src/dom';

/// Puts a list of tabs before the first of the panels, which have an id each.
export function addTabs(name: string, panels: [title: string, panel: HTMLElement][]): void {
  const tabs = panels.map(([title, panel]) =>
    make(
      'button',
      {
        type: 'button',
        role: 'tab',
        id: `tab-${panel.id}`,
        'aria-controls': panel.id,
        click: () => choose(panel),
      },
      title,
    ),
  );
  const choose = (shown: HTMLElement) =>
    panels.forEach(([, panel], i) => {
      panel.hidden = panel !== shown;
      tabs[i].setAttribute('aria-selected', String(panel === shown));
      tabs[i].tabIndex = panel === shown ? 0 : -1;
    });
  for (const [i, [, panel]] of panels.entries()) {
    panel.setAttribute('role', 'tabpanel');
    panel.setAttribute('aria-labelledby', tabs[i].id);
    tabs[i].addEventListener('keydown', ({ key }) => {
      const step = key === 'ArrowRight' ? 1 : key === 'ArrowLeft' ? panels.length - 1 : 0;
      if (step === 0) return;
      const next = (i + step) % panels.length;
      choose(panels[next][1]);
      tabs[next].focus();
    });
  }
  panels[0][1].before(make('div', { role: 'tablist', class: 'tabs', 'aria-label': name }, ...tabs));
  choose(panels[0][1]);
}
