// Makes dist/ for npm of the page's modules: scancast-view.js with all that it needs in one file, and its types.
//
//   node client/embed/pack.mjs [FOLDER]     # by default client/embed/dist; `npm pack` and `npm publish` call it
//
// The modules import by name and export by name, and no two of them each other: then one file is each module as a function
// that gives what it exports, in the order in which they need each other. Types are TypeScript's, made of the comments; where
// tests/browser/node_modules lacks it, they are left out, and that is said.

import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('../web/', import.meta.url));
const entry = join(web, 'scancast-view.js');

const importPattern = /^import\s+(?:\{([^}]*)\}\s+from\s+)?'([^']+)';\n/gm;
// What comes when it is first used, in a page of many files; in comments, which name types so, a brace stands before it.
const laterPattern = /(?<!\{)\bimport\('(\.[^']+)'\)/g;
const exportPattern = /^export\s+(?=(?:async\s+)?(?:function\*?|class|const|let)\s+([A-Za-z_$][\w$]*))/gm;

/** { names, source }: what a module exports, and its text without the words import and export. */
function moduleOf(file) {
  const text = readFileSync(file, 'utf8');
  const needs = [];
  let source = text.replace(importPattern, (_, names, from) => {
    const target = resolve(dirname(file), from);
    needs.push(target);
    return names === undefined ? '' : `const {${names.replace(/\bas\b/g, ':')}} = ${nameOf(target)};\n`;
  });
  source = source.replace(laterPattern, (_, from) => {
    const target = resolve(dirname(file), from);
    needs.push(target);
    return `Promise.resolve(${nameOf(target)})`;
  });
  const names = [];
  source = source.replace(exportPattern, (_, name) => {
    names.push(name);
    return '';
  });
  const strange = /^(?:import|export)\b(?!\.).*$/m.exec(source);
  if (strange) throw new Error(`${file}: "${strange[0]}" is no import or export that this reads`);
  return { needs, names, source };
}

/** What the module is called in the one file. */
const nameOf = (file) => `of_${relative(web, file).replace(/\.js$/, '').replace(/[^A-Za-z0-9]/g, '_')}`;

/** Its modules in the order in which they need each other, as one text. */
export function bundle() {
  const done = new Map();
  const underway = new Set();
  const visit = (file) => {
    if (done.has(file)) return;
    if (underway.has(file)) throw new Error(`${file} needs itself, by way of others`);
    underway.add(file);
    const module = moduleOf(file);
    module.needs.forEach(visit);
    done.set(file, module);
  };
  visit(entry);
  const parts = [...done].map(([file, { names, source }]) => (file === entry
    ? source
    : `const ${nameOf(file)} = (() => {\n${source}\nreturn { ${names.join(', ')} };\n})();\n`));
  const { names } = done.get(entry);
  return `// @scancast/view: made by client/embed/pack.mjs of client/web/.\n${parts.join('')}\nexport { ${names.join(', ')} };\n`;
}

function packTypes(folder) {
  const tsc = fileURLToPath(new URL('../../tests/browser/node_modules/typescript/bin/tsc', import.meta.url));
  if (!existsSync(tsc)) {
    console.error('No types: TypeScript is missing. Run: (cd tests/browser && npm ci --ignore-scripts)');
    return;
  }
  const { status, stdout } = spawnSync(process.execPath, [tsc, '--allowJs', '--declaration', '--emitDeclarationOnly', '--skipLibCheck',
    '--target', 'es2022', '--module', 'es2022', '--moduleResolution', 'bundler', '--lib', 'es2023,dom,dom.iterable',
    '--outDir', join(folder, 'types'), '--rootDir', web, entry], { encoding: 'utf8' });
  if (status !== 0) throw new Error(`TypeScript made no types:\n${stdout}`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folder = resolve(process.argv[2] ?? fileURLToPath(new URL('dist', import.meta.url)));
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const text = bundle();
  writeFileSync(join(folder, basename(entry)), text);
  packTypes(folder);
  console.log(`${join(folder, basename(entry))}: ${text.length} bytes`);
}
