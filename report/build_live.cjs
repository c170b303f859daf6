// Bundles live.html, with the library in it: node build_live.cjs PACKAGE FILE, of the built package for npm. Packages are found by
// NODE_PATH or in node_modules.
const { readFileSync, writeFileSync } = require('fs');
const { join } = require('path');
const { deflateRawSync } = require('zlib');
const { bundle, pageOf } = require('./build.cjs');

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

/// The colours of src/io/image/pictures/color_scale, which reports have in their data.
function colors() {
  const scale = ['h', 'cpp'].map((type) => readFileSync(join(__dirname, `../src/io/image/pictures/color_scale.${type}`), 'utf8')).join('');
  const names = {
    viridis: 'Viridis', diverging: 'Diverging', paper2006: 'Paper2006', opposite: 'Opposite', within: 'Within', above: 'Above', below: 'Below',
    no_value: 'NoValue', unjudged: 'Unjudged',
  };
  return Object.fromEntries(
    Object.entries(names).map(([key, name]) => {
      const found = scale.match(new RegExp(`\\bk${name}\\s*(?:=\\s*)?\\{[\\s\\d,{}]*\\}`));
      const list = [...(found?.[0].matchAll(/(\d+),\s*(\d+),\s*(\d+)/g) ?? [])].map((rgb) => rgb.slice(1).map(Number));
      if (list.length === 0) throw new Error(`color_scale.h and color_scale.cpp have no colours k${name}`);
      return [key, list];
    }),
  );
}

const [library, file] = process.argv.slice(2);
const { version } = JSON.parse(readFileSync(join(library, 'package.json'), 'utf8'));
const program = bundle('../live/main.ts', {
  alias: { sdm: join(library, 'index.js') },
  loader: { '.ply': 'binary' },
  define: { SDM_COLORS: JSON.stringify(colors()), SDM_VERSION: JSON.stringify(version) },
  external: ['node:*'],
  logOverride: { 'empty-import-meta': 'silent' }, // of files that the page has in it
});
const files = { 'sdm-module': 'sdm_full.wasm', 'sdm-worker': 'worker.js', 'sdm-report': 'report_page.html' };
writeFileSync(
  file,
  pageOf('live', 'sdm live', bundle('page.css') + bundle('../live/live.css'), program, {
    content: 'page.html',
    data: Object.entries(files).map(([id, name]) => packed(id, join(library, name))).join('\n'),
    sources: " 'wasm-unsafe-eval'; worker-src blob:",
  }),
);
