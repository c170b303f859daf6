// When and from what a page was made: a line on paper.
import { byId } from './dom';

interface NamedInput {
  file: string;
  xxh3?: string; ///< of the bytes of the file
}

interface Made {
  version: string;
  date?: string; ///< in UTC, such as 2006-07-01T12:30Z; absent in older pages
}

export function showMade(inputs: (NamedInput | undefined)[], { version, date }: Made): void {
  const names = inputs
    .filter((i): i is NamedInput => i !== undefined)
    .map(({ file, xxh3 }) => `${file.split(/[\\/]/).pop()}${xxh3 ? ` (XXH3 ${xxh3})` : ''}`);
  const when = date ? `Measured on ${date.replace('T', ' at ').replace('Z', ' UTC')} with` : 'Measured with';
  byId('made').textContent = `${when} sdm ${version}: ${names.join(', ')}`;
  byId('made').hidden = false;
}
