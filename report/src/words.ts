// What is measured, in words.
import type { Report } from './page_data';

export function isSigned(report: Report): boolean {
  return report.sign !== undefined && report.sign.method !== 'none';
}

export function isThickness(report: Report): boolean {
  return report.thickness !== undefined || report.measured?.kind === 'thickness';
}

export function quantityOf(report: Report): string {
  return isThickness(report) ? 'thickness' : 'distance';
}

export function capital(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/// What the signs of the largest and of the smallest distance mean: of the closest point of a solid that of its
/// inside, otherwise that of the side of the face that is measured to.
export function endsOf(report: Report): { largest: string; smallest: string } {
  if (!isSigned(report) || isThickness(report)) return { largest: 'Largest', smallest: 'Smallest' };
  const byFace = report.sign?.method === 'side' || (report.measured && report.measured.kind !== 'closest');
  return byFace
    ? { largest: 'Largest (most in front)', smallest: 'Smallest (most behind)' }
    : { largest: 'Largest (most outside)', smallest: 'Smallest (most inside)' };
}

/// Words of the report, which names the meshes O1 and O2, as the page names them.
export function named(words: string, report: Report): string {
  const [o1, o2] = report.measured_on === 'o2' ? ['reference', 'part'] : ['part', 'reference'];
  return words.replace(
    /(^|[.:] )?\bO([12])\b/g,
    (_, start: string | undefined, n) =>
      `${start ?? ''}${start === undefined ? 'the' : 'The'} ${n === '1' ? o1 : o2}`,
  );
}
