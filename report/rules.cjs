// The module sdm-rules, by the text of src/core/rules.h, and the words of Colormap: node rules.cjs FOLDER writes rules.js and rules.d.ts.
const { readFileSync, writeFileSync } = require('fs');
const { join } = require('path');

const kTypes = { double: 'number', bool: 'boolean', Rgb: '[number, number, number]', Unit: '[string, number]' };

const camel = (code) => code.replace(/\b[a-z]+(?:_[a-z]+)+\b/g, (name) => name.replace(/_(.)/g, (_, c) => c.toUpperCase()));

/// A function in JavaScript, its declaration, and it in GLSL.
function ofFunction(type, name, list, body) {
  const parameters = list.split(/,\s*/).map((parameter) => parameter.split(' '));
  const inJs = body.replace(/\bstd::/g, 'Math.').replace(/\bconst (double|bool) /g, 'const ');
  const unknown = [type, ...parameters.map(([of]) => of)].find((of) => !(of in kTypes)) ?? inJs.match(/::|<\w+>|\b(auto|int|double|for|while)\b/)?.[0];
  if (unknown) throw new Error(`src/core/rules.h: ${name}() has '${unknown}', which is not translated`);
  return [
    `export function ${name}(${parameters.map(([, parameter]) => parameter).join(', ')}) ${inJs}`,
    `export declare function ${name}(${parameters.map(([of, parameter]) => `${parameter}: ${kTypes[of]}`).join(', ')}): ${kTypes[type]};`,
    `${type} ${name}(${list}) ${body}`.replace(/\bstd::|\bconst /g, '').replace(/\bdouble\b/g, 'float'),
  ];
}

/// The same of a number.
function ofNumber(name, value) {
  const inJs = value.replace('std::numericLimits<double>::infinity()', 'Infinity');
  return [`export const ${name} = ${inJs};`, `export declare const ${name}: number;`, `const float ${name} = ${value};`];
}

/// The same of what has braces, but not in GLSL.
function ofList(type, name, list) {
  const [, of] = type.match(/^std::array<(.*), \d+>$/) ?? [];
  const all = JSON.parse(list.replace(/\{/g, '[').replace(/\}/g, ']'));
  const value = JSON.stringify(of && of !== 'const char*' ? all[0] : all);
  return [`export const ${name} = ${value};`, `export declare const ${name}: ${!of ? kTypes[type] : kTypes[of] ? `${kTypes[of]}[]` : `readonly ${value}`};`];
}

function translated() {
  const source = readFileSync(join(__dirname, '../src/core/rules.h'), 'utf8');
  const [js, types, glsl] = [[], [], []];
  source.split(/^\/\/ (?:GLSL:.*|Not GLSL\.)$/m).forEach((part, i) => {
    const found = camel(part.replace(/\s*\/\/.*/g, '')).matchAll(
      /^inline (?:constexpr )?(std::array<.*?>|\w+) (\w+)(?:\(([^)]*)\) (\{\n[^]*?\n\})$| = (.*?);$|(\{[^;]*\});$)/gm);
    for (const [, type, name, parameters, body, value, list] of found) {
      const [inJs, declared, inGlsl] = body ? ofFunction(type, name, parameters, body) : value ? ofNumber(name, value) : ofList(type, name, list);
      js.push(inJs), types.push(declared);
      if (i === 1) glsl.push(inGlsl);
    }
  });
  const declarations = source.match(/^inline /gm).length;
  if (js.length !== declarations) throw new Error(`src/core/rules.h: ${js.length} of ${declarations} declarations are translated`);
  const [, words] = readFileSync(join(__dirname, '../include/sdm/summary.h'), 'utf8').match(/kWords<Colormap>\{([^}]*)\}/);
  const [names, declared] = ofList('std::array<const char*, 0>', 'kColormapNames', `{${words}}`);
  js.push(names), types.push(declared);
  js.push(`export const kColorRule = ${JSON.stringify(glsl.join('\n'))};`);
  types.push('/** The functions and numbers of colours, in GLSL. */\nexport declare const kColorRule: string;');
  return { js: `${js.join('\n')}\n`, types: `${types.join('\n')}\n` };
}

const { js, types } = translated();
if (require.main === module) {
  writeFileSync(join(process.argv[2], 'rules.js'), js);
  writeFileSync(join(process.argv[2], 'rules.d.ts'), types);
}

/// What esbuild has to know, for imports of sdm-rules.
module.exports = { alias: { 'sdm-rules': `data:text/javascript;base64,${Buffer.from(js).toString('base64')}` } };
