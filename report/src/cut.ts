// Cuts a view open where the form says.
import type { State } from './state';
import { byId } from './dom';
import type { Vec } from './page_data';
import type { SectionView } from './section_view';
import type { Subject } from './subject';
import type { View } from './view';

/// What the lines of a section are.
function sectionWords({ part, other, factor }: SectionView): string {
  if (!part) return other ? 'Dark line: the reference.' : '';
  const inside = part.isClosed ? ' Grey: inside of the part.' : '';
  if (!other) return `The thick line is the profile of the part in the colours of its values.${inside}`;
  const gap = `${factor > 1 ? `${factor} times ` : ''}as long as the gap to the reference`;
  return `Thick line in colours: the part. Dark line: the reference. Thin lines towards it: ${gap} in this plane.${other.isClosed && part.isClosed ? ' Orange: only the part; blue: only the reference; grey: both.' : inside}`;
}

/// Shows a section; `before`: the axis of the one that is shown, returned for the next call. The cut surface of a section that
/// is new faces the viewer.
export function cutOpen(
  view: View,
  subject: Subject,
  shown: SectionView,
  section: State['section'],
  before: State['section']['axis'],
): State['section']['axis'] {
  const { axis } = section;
  if (axis === null) {
    view.setCut(null);
    return null;
  }
  if (axis !== before) {
    const { position, target } = view.pose;
    section.flipped = position[axis] < target[axis];
    (byId('section-flip') as HTMLInputElement).checked = section.flipped;
  }
  const [least, most] = [subject.lo[axis], subject.hi[axis]];
  const sign = section.flipped ? -1 : 1;
  const normal: Vec = [0, 0, 0];
  normal[axis] = sign;
  view.setCut({ normal, offset: sign * (least + section.at * (most - least)) });
  byId('section-words').textContent = sectionWords(shown);
  return axis;
}
