// Files of the package, from a disk in Node and by fetch() in pages.
import { SdmError } from './types.js';

export async function load(url: URL): Promise<Response> {
  if (url.protocol === 'file:' && typeof process === 'object') {
    const { readFile } = await import('node:fs/promises');
    return new Response(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok)
    throw new SdmError('internal', `${url} cannot be loaded: ${response.status} ${response.statusText}`);
  return response;
}

/** The page that reports are written into: its text, or where it is. */
export interface ReportPage {
  text: string | undefined;
  url: string | undefined;
}

export async function textOf({ text, url }: ReportPage): Promise<string> {
  if (text !== undefined) return text;
  if (url === undefined)
    throw new SdmError('input', 'a report needs the option reportPage, the text of report_page.html');
  return (await load(new URL(url))).text();
}
