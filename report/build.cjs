// Bundles the page into one HTML file: node build.cjs OUTPUT. Packages are found by NODE_PATH or in node_modules.
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

// A function as the replacement: in a string, $& and the like have a meaning.
const page = readFileSync(join(__dirname, 'src', 'page.html'), 'utf8')
  .replace('/* style */', () => bundle('page.css'))
  .replace('/* program */', () => bundle('main.ts'));
writeFileSync(process.argv[2], page);
