// Bundles the pages into one HTML file each, page.html and player.html: node build.cjs FOLDER. Packages are found by NODE_PATH or in node_modules.
const { buildSync } = require('esbuild');
const { readFileSync, writeFileSync } = require('fs');
const { delimiter, join } = require('path');

function bundle(file) {
  const { outputFiles } = buildSync({
    entryPoints: [join(__dirname, 'src', file)],
    bundle: true,
    nodePaths: (process.env.NODE_PATH || '').split(delimiter),
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome103', 'firefox113', 'safari16.4'],
    charset: 'utf8',
    legalComments: 'inline',
  });
  return outputFiles[0].text.trim();
}

// Functions as the replacements: in a string, $& and the like have a meaning.
for (const [page, program] of [['page', 'main.ts'], ['player', 'player.ts']])
  writeFileSync(
    join(process.argv[2], `${page}.html`),
    readFileSync(join(__dirname, 'src', `${page}.html`), 'utf8')
      .replace('/* style */', () => bundle('page.css'))
      .replace('/* program */', () => bundle(program)),
  );
