// Holds Kubernetes objects against the published schemas, without a cluster and without the network: npm's kubernetes-models is made
// of Kubernetes' own OpenAPI document, and of the Prometheus operator's.
//
//     node kubernetes_schema.mjs < objects.json      # [{"apiVersion": …, "kind": …}, …]
//
// Each object is judged twice: by its validator (types, formats, patterns, what is required), which lets fields pass that it does not
// know, and as a TypeScript literal of its type, in which a field that the schema lacks is an error. Prints what is wrong, a line each, and
// ends with 1 then; with 2 when it could not judge.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const ts = createRequire(join(here, '../browser/package.json'))('typescript');
const require = createRequire(import.meta.url);

/** Groups that are not in kubernetes-models itself. */
const packages = { 'monitoring.coreos.com': '@kubernetes-models/prometheus-operator' };

/** The module that has an object's class: "apps/v1", "Deployment" → kubernetes-models/apps/v1/Deployment. */
function moduleOf({ apiVersion, kind }) {
  if (!/^[\w./-]+$/.test(apiVersion ?? '') || !/^\w+$/.test(kind ?? '')) return undefined;
  return `${packages[apiVersion.split('/')[0]] ?? 'kubernetes-models'}/${apiVersion}/${kind}`;
}

const nameOf = (object) => `${object.kind} ${object.metadata?.name ?? ''}`.trim();

/** What the validators say. */
function judgedByValidators(objects) {
  const wrong = [];
  for (const object of objects) {
    try {
      const { [object.kind]: Kind } = require(moduleOf(object) ?? '');
      new Kind(object).validate();
    } catch (error) {
      wrong.push(`${nameOf(object)}: ${error.code === 'MODULE_NOT_FOUND' ? `no schema of ${object.apiVersion}` : error.message}`);
    }
  }
  return wrong;
}

/** What the compiler says of all objects as literals of their types; one file that exists in memory only. */
function judgedByTypes(objects) {
  const file = join(here, 'objects-in-memory.ts');
  const lines = [];
  objects.forEach((object, i) => {
    lines.push(`import type { I${object.kind} as T${i} } from ${JSON.stringify(moduleOf(object))};`,
      `export const object${i}: T${i} = ${JSON.stringify(object)};`);
  });
  const text = lines.join('\n');
  const options = {
    noEmit: true, strict: true, skipLibCheck: true, types: [], lib: ['lib.es2020.d.ts'], target: ts.ScriptTarget.ES2020,
    module: ts.ModuleKind.CommonJS, moduleResolution: ts.ModuleResolutionKind.Node10,
  };
  const host = ts.createCompilerHost(options);
  const { getSourceFile, fileExists, readFile } = host;
  host.getSourceFile = (name, ...more) => (name === file ? ts.createSourceFile(name, text, options.target) : getSourceFile(name, ...more));
  host.fileExists = (name) => name === file || fileExists(name);
  host.readFile = (name) => (name === file ? text : readFile(name));
  return ts.getPreEmitDiagnostics(ts.createProgram([file], options, host)).map((found) => {
    const line = found.file?.fileName === file ? found.file.getLineAndCharacterOfPosition(found.start).line : -1;
    const object = objects[Math.floor(line / 2)];
    return `${object ? nameOf(object) : 'types'}: ${ts.flattenDiagnosticMessageText(found.messageText, ' ')}`;
  });
}

const objects = JSON.parse(readFileSync(0, 'utf8'));
if (!Array.isArray(objects) || !objects.length) {
  console.error('standard input is no list of objects');
  process.exit(2);
}
let wrong = judgedByValidators(objects);
const known = objects.filter((object) => moduleOf(object) && !wrong.some((line) => line.startsWith(`${nameOf(object)}: no schema`)));
wrong = wrong.concat(judgedByTypes(known));
wrong.forEach((line) => console.log(line));
process.exit(wrong.length ? 1 : 0);
