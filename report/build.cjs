// Bundles the pages, page.html and player.html in shell.html, into one HTML file each: node build.cjs FOLDER. Packages are found by NODE_PATH or in node_modules.
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
  return outputFiles[0].text.trim().replace(/\n[\t ]+/g, '\n'); // shaders are indented
}

// Functions as the replacements: in a string, $& and the like have a meaning.
const read = (file) => readFileSync(join(__dirname, 'src', file), 'utf8');
const pages = { page: ['Distance report', 'main.ts'], player: ['Distances over time', 'player.ts'] };
for (const [name, [title, program]] of Object.entries(pages))
  writeFileSync(
    join(process.argv[2], `${name}.html`),
    read('shell.html')
      .replace('<!-- name -->', name)
      .replace('<!-- title -->', title)
      .replace('<!-- content -->\n', () => read(`${name}.html`))
      .replace('/* style */', () => bundle('page.css'))
      .replace('/* program */', () => bundle(program)),
  );
