// The picture on paper.
import { byId, make } from './dom';
import type { Viewer } from './viewer';

/// While the page is printed, the canvas has the size that it has on paper, and an image of it is over it: browsers print
/// a canvas as it was before, at the size that it has now. Returns how to stop that.
export function printPicture(view: Viewer): () => void {
  const print = (on: boolean) => {
    byId('view').classList.toggle('printing', on);
    view.resize();
    view.drawNow();
    document.getElementById('printed')?.remove();
    if (on) byId('canvas').after(make('img', { id: 'printed', alt: '', src: view.canvas.toDataURL() }));
  };
  const [before, after] = [() => print(true), () => print(false)];
  window.addEventListener('beforeprint', before);
  window.addEventListener('afterprint', after);
  return () => {
    window.removeEventListener('beforeprint', before);
    window.removeEventListener('afterprint', after);
  };
}
