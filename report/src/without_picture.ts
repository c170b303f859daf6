// The page where no picture can be drawn: all that is not in 3D.
import { startOf } from './state';
import { byId } from './dom';
import { drawHistogram } from './histogram';
import type { PageData, Report } from './page_data';
import { showPlaces } from './places';
import { showOmissions } from './tables';

export function showWithoutPicture(report: Report, data: PageData): void {
  const logarithmic = byId('logarithmic') as HTMLInputElement;
  const { scale } = startOf(report, data.area, false);
  const draw = () => drawHistogram(report, data.area, scale, logarithmic.checked);
  logarithmic.addEventListener('change', draw);
  new ResizeObserver(draw).observe(byId('histogram-chart'));
  showPlaces(report, data.page, (data.surface?.model ?? data.cloud!).size);
  showOmissions(report, data);
  byId('controls').hidden = true;
}
