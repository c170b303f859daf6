// Files of the package, from a disk in Node and by fetch() in pages.
import { platform } from './platform.js';
import { SdmError } from './types.js';

export async function load(url: URL): Promise<Response> {
  const refuse = (why: string) => new SdmError('internal', `${url} cannot be loaded: ${why}`);
  const response = await platform()
    .load(url)
    .catch((error: Error) => {
      throw refuse(error.message);
    });
  if (!response.ok) throw refuse(`${response.status} ${response.statusText}`);
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
    throw new SdmError('input', 'a report needs the option reportPage, the text of report_page.txt');
  return (await load(new URL(url))).text();
}
