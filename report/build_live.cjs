// Bundles live.html, with the library in it: node build_live.cjs PACKAGE FILE, of the built package for npm. Packages are found by
// NODE_PATH or in node_modules.
const { readFileSync, writeFileSync } = require('fs');
const { join } = require('path');
const { deflateRawSync } = require('zlib');
const { bundle, pageOf } = require('./build.cjs');
const { alias } = require('./rules.cjs');

/// The digits of base85() of src/io/page/report/packed_arrays.h: '#' to 'x', without '<'.
function base85(bytes) {
  const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
  const text = Buffer.alloc((padded.length / 4) * 5);
  for (let i = 0, at = 0; i < padded.length; i += 4, at += 5) {
    let group = padded.readUInt32BE(i);
    for (let k = 4; k >= 0; --k, group = Math.floor(group / 85)) text[at + k] = (group % 85) + (group % 85 >= 25 ? 36 : 35);
  }
  return text.toString('latin1');
}

/// A file in the page, packed, as live/start.ts reads it.
function packed(id, file) {
  const bytes = deflateRawSync(readFileSync(file), { level: 9 });
  return `<script type="text/plain" id="${id}" data-bytes="${bytes.length}">${base85(bytes)}</script>`;
}

const [library, file] = process.argv.slice(2);
const { version } = JSON.parse(readFileSync(join(library, 'package.json'), 'utf8'));
const program = bundle('../live/main.ts', {
  alias: { ...alias, sdm: join(library, 'index.js') },
  loader: { '.ply': 'binary' },
  define: { SDM_VERSION: JSON.stringify(version) },
  logOverride: { 'empty-import-meta': 'silent' }, // of files that the page has in it
});
const files = { 'sdm-module': 'sdm_full.wasm', 'sdm-worker': 'worker.js', 'sdm-report': 'report_page.txt' };
writeFileSync(
  file,
  pageOf('live', 'sdm live', bundle('page.css') + bundle('../live/live.css'), program, {
    content: 'page.html',
    data: Object.entries(files).map(([id, name]) => packed(id, join(library, name))).join('\n'),
    sources: " 'wasm-unsafe-eval'; worker-src blob:",
  }),
);
