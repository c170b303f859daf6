// The page of report.html: the text first, then the part.
import { showGroups } from './group_table';
import { nameSubject, showVerdict } from './headline';
import { openPage } from './open_page';
import { readReport } from './page_data';
import { readData } from './read_page';
import { copyOfPage, readSaved } from './saved';
import { showWithoutPicture } from './without_picture';
import { showFields, showInputs, showMethod, showNumbers } from './tables';
import { showMore } from './json_tables';
import { Page } from './page';

const copy = copyOfPage();
const saved = readSaved();
const report = readReport();
nameSubject(report);
showVerdict(report);
showFields(report);
showNumbers(report);
showInputs(report);
showMethod(report);
showGroups(report);
showMore(report);
void openPage('sdmPage', 'part', 'The numbers are complete.', async () => {
  const data = await readData();
  try {
    return new Page(report, data, copy, saved);
  } catch (error) {
    showWithoutPicture(report, data);
    throw error;
  }
});
