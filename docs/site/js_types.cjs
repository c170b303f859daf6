// Prints the reference of the package for npm, from its types: node js_types.cjs JS_FOLDER DECLARED, the declared.d.ts of the package, if
// there is one. TypeScript is found by NODE_PATH.
const { existsSync, readFileSync } = require('fs');
const { join, resolve } = require('path');
const ts = require('typescript');

const folder = resolve(process.argv[2]), declared = process.argv[3];
const entries = { sdm: 'index.ts', 'sdm/three': 'three.ts' };
const options = {
  target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.ESNext, moduleResolution: ts.ModuleResolutionKind.Bundler, declaration: true,
  emitDeclarationOnly: true, stripInternal: true, skipLibCheck: true, types: [], lib: ['lib.es2022.d.ts', 'lib.dom.d.ts', 'lib.esnext.disposable.d.ts'],
};

/** The declarations of the sources, by the names of the files. */
function declarations() {
  const program = ts.createProgram(Object.values(entries).map((file) => join(folder, 'src', file)), options);
  const files = new Map();
  program.emit(undefined, (name, text) => files.set(resolve(name).replace(/\.d\.ts$/, ''), ts.createSourceFile(name, text, options.target, true)));
  if (existsSync(declared)) files.set(join(folder, 'src/declared'), ts.createSourceFile(declared, readFileSync(declared, 'utf8'), options.target, true));
  return files;
}

/** The names that a file exports, its own and those of others, each with its declaration. */
function exported(files, file) {
  const found = new Map();
  const declaredIn = (from, name) => {
    for (const statement of files.get(from).statements)
      if (statement.name?.text === name || statement.declarationList?.declarations.some((one) => one.name.text === name)) return [from, statement];
  };
  for (const statement of files.get(file).statements) {
    if (ts.isExportDeclaration(statement)) {
      if (!statement.moduleSpecifier) continue;
      const from = join(file, '..', statement.moduleSpecifier.text.replace(/\.js$/, ''));
      if (!statement.exportClause) for (const [name, found_] of exported(files, from)) found.set(name, found_);
      else if (files.has(from)) for (const { name } of statement.exportClause.elements) found.set(name.text, declaredIn(from, name.text));
    } else if (ts.getCombinedModifierFlags(statement) & ts.ModifierFlags.Export) {
      const name = statement.name?.text ?? statement.declarationList.declarations[0].name.text;
      found.set(name, [file, statement]);
    }
  }
  return found;
}

/** The comment of a declaration, and its code without that and without what is private. */
function parts([file, statement], files) {
  const source = files.get(file).text;
  const ranges = ts.getLeadingCommentRanges(source, statement.pos) ?? [];
  const comment = ranges.filter(({ pos }) => source.startsWith('/**', pos)).pop();
  const words = comment ? source.slice(comment.pos + 3, comment.end - 2).replace(/\n\s*\* ?/g, '\n').trim() : '';
  const code = source.slice(statement.getStart(), statement.end).replace(/^export (declare )?/, '').replace(/\n\s+private [^\n]*/g, '');
  return { words, code };
}

const files = declarations();
let page = '# JavaScript\n\nWhat the package for npm exports. [JavaScript and the browser](docs/javascript.md) explains how it is used.\n';
for (const [entry, file] of Object.entries(entries)) {
  page += `\n## ${entry}\n`;
  for (const [name, found] of exported(files, join(folder, 'src', file.replace('.ts', '')))) {
    if (!found) throw new Error(`${entry}: ${name} is not declared`);
    const { words, code } = parts(found, files);
    page += `\n### ${name}\n\n${words ? `${words}\n\n` : ''}\`\`\`typescript\n${code}\n\`\`\`\n`;
  }
}
const generated = join(folder, 'src/declared');
if (files.has(generated)) {
  page += '\n## Options and results that are declared in C++\n';
  for (const [name, found] of exported(files, generated))
    if (ts.isInterfaceDeclaration(found[1])) page += `\n### declared.${name}\n\n\`\`\`typescript\n${parts(found, files).code}\n\`\`\`\n`;
}
process.stdout.write(page);
