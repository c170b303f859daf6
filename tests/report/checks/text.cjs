// What the page says in words and numbers, and the files with them.
const assert = require('assert');
const { readFileSync } = require('fs');
const { createRequire } = require('module');
const { join } = require('path');
const { plain } = require('./support.cjs');
const { alias } = require('../../../report/rules.cjs');

module.exports = {
  // The fraction out of tolerance is one number, in the banner and below the sliders, and by the bins nearly the same.
  async percentages(page, fraction) {
    const percents = (text) => [...plain(text).matchAll(/([\d.]+).%/g)].map((match) => Number(match[1]));
    const [stated] = percents(await page.textContent('#sentence'));
    const [below] = percents(await page.textContent('#what-if'));
    assert.strictEqual(below, stated);
    assert.match(plain(await page.textContent('#next')), /^For the part.*(out of tolerance|may be missing)/);
    assert(Math.abs(stated - 100 * fraction) <= 0.0051 * Math.max(1, stated), `${stated} for ${100 * fraction}`);
    const { stated: number, binned } = await page.evaluate(() => window.sdmPage.outside());
    assert.strictEqual(number, Number(fraction));
    assert(Math.abs(binned - fraction) < 0.01, `${binned} by bins for ${fraction}`);
  },

  // Other limits are judged in the page as by the library: what judge() in include/sdm/tolerance.h says in `cases`.
  async judges(page, cases) {
    const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
    const entry = join(__dirname, '../../../report/src/verdict.ts');
    const { outputFiles } = buildSync({ entryPoints: [entry], bundle: true, alias, write: false, format: 'cjs' });
    const built = { exports: {} };
    new Function('module', 'exports', outputFiles[0].text)(built, built.exports);
    for (const { evidence, lower, upper, ...expected } of JSON.parse(readFileSync(cases, 'utf8'))) {
      const found = built.exports.judge(evidence, { lower, upper });
      assert.deepStrictEqual(found, expected, JSON.stringify({ evidence, lower, upper }));
    }
  },

  // Every number of report.json is in the CSV as it is there, and so are the callouts.
  async csv(page, reportJson) {
    await page.click('#worst-table tbody tr:first-child button');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-numbers')]);
    assert.strictEqual(download.suggestedFilename(), 'numbers.csv');
    const [head, ...lines] = readFileSync(await download.path(), 'utf8').trimEnd().split('\r\n');
    assert.strictEqual(head, 'name,value');
    const rows = new Map(lines.map((line) => [line.slice(0, line.indexOf(',')), line.slice(line.indexOf(',') + 1)]));
    assert.strictEqual(rows.size, lines.length, 'a name occurs twice');
    let count = 0;
    const compare = (value, path) => {
      if (value !== null && typeof value === 'object') {
        if (Array.isArray(value) && value.length > 0 && value.every((x) => x === null || typeof x !== 'object'))
          return compare(value.join(' '), path);
        return Object.entries(value).forEach(([key, x]) => compare(x, path ? `${path}.${key}` : key));
      }
      const quoted = rows.get(path);
      assert.notStrictEqual(quoted, undefined, path);
      const found = quoted.startsWith('"') ? quoted.slice(1, -1).replace(/""/g, '"') : quoted;
      if (typeof value === 'number') assert.strictEqual(Number(found), value, path);
      else assert.strictEqual(found, value === null ? '' : String(value), path);
      ++count;
    };
    const report = JSON.parse(readFileSync(reportJson, 'utf8'));
    compare(report, '');
    assert.ok(count > 60, `${count} values`);
    assert.strictEqual(rows.get('fields.part'), '"4711, ""left"""');
    assert.ok(rows.has('callouts.0.distance'));
    assert.ok((await page.textContent('#fields')).includes('4711, "left"'));
  },

  // Opens, and says these words, but not those after a "!"; any words if none are given.
  async says(page, ...words) {
    const text = plain(await page.innerText('body'));
    for (const word of words)
      if (word.startsWith('!')) assert(!text.includes(word.slice(1)), `"${word.slice(1)}" in: ${text}`);
      else assert(text.includes(word), `no "${word}" in: ${text}`);
  },
};
