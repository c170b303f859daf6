// Bundles the pages, page.html, player.html and baked.html in shell.html, into one HTML file each: node build.cjs FOLDER. Packages are found by NODE_PATH or in node_modules.
const { buildSync } = require('esbuild');
const { readFileSync, writeFileSync } = require('fs');
const { delimiter, join } = require('path');
const { alias } = require('./rules.cjs');

function bundle(file, options = {}) {
  const { outputFiles } = buildSync({
    entryPoints: [join(__dirname, 'src', file)],
    bundle: true,
    alias,
    nodePaths: (process.env.NODE_PATH || '').split(delimiter),
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome103', 'firefox113', 'safari16.4'],
    charset: 'utf8',
    legalComments: 'inline',
    ...options,
  });
  return outputFiles[0].text.trim();
}

/// Takes comments, indentation and blanks beside signs from shaders, the only text of several lines but for licences. A line
/// with a backtick or an end of a licence may have code of the program, as have the first and the last, and keeps its blanks.
function withShortShaders(text) {
  const lines = text.replace(/\n[\t ]+/g, '\n').split('\n');
  const short = lines.map((line, i) => {
    if (i === 0 || i === lines.length - 1 || /`|\/\*\*|^\*/.test(line)) return line;
    const code = line.replace(/\/\/.*/, '').trim();
    return code.startsWith('#') || code.includes('${') ? code : code.replace(/ *([=*/(),;<>{}?:&|]) */g, '$1');
  });
  return short.filter((line) => line !== '').join('\n');
}

// Functions as the replacements: in a string, $& and the like have a meaning.
const read = (file) => readFileSync(join(__dirname, 'src', file), 'utf8');
const pages = { page: ['Distance report', 'main.ts'], player: ['Distances over time', 'player.ts'], baked: ['Baked textures', 'baked.ts'] };

/// A page with its program; `also`: texts in place of marks of shell.html.
function pageOf(name, title, style, program, also = {}) {
  return read('shell.html')
    .replace('<!-- name -->', name)
    .replace('<!-- title -->', title)
    .replace('<!-- sources -->', also.sources ?? '')
    .replace('<!-- content -->\n', () => read(also.content ?? `${name}.html`))
    .replace('/* style */', () => style)
    .replace('<!-- data -->', () => also.data ?? '<!-- data -->')
    .replace('/* program */', () => withShortShaders(program));
}

if (require.main === module)
  for (const [name, [title, program]] of Object.entries(pages))
    writeFileSync(join(process.argv[2], `${name}.html`), pageOf(name, title, bundle('page.css'), bundle(program)));

module.exports = { bundle, pageOf };
