// Adds the beginning of a page to each result of a search. pageSummaries: the texts by the names of pages.
addEventListener('DOMContentLoaded', () => {
  const results = document.getElementById('search-results');
  if (!results) return;
  const root = document.getElementById('documentation_options').getAttribute('data-url_root');
  const folder = new URL(root, location.href).href;
  new MutationObserver((changes) => {
    for (const { addedNodes } of changes)
      for (const item of addedNodes) {
        const link = item.tagName === 'LI' && item.querySelector('a');
        if (!link) continue;
        const name = decodeURI(link.href.slice(folder.length).replace(/\.html.*/, ''));
        const text = pageSummaries[name];
        if (!text) continue;
        const summary = document.createElement('p');
        summary.className = 'search-summary';
        summary.textContent = text;
        item.append(summary);
      }
  }).observe(results, { childList: true, subtree: true });
});
