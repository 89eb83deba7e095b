// A view in the words of the protocol's one vocabulary: the snapshot's query, and behind the # of a link. Pure.
//
// A view here is the JSON view, or part of it: { camera, method, param, color, … }; null leaves the choice to the server.
// Reading is strict: a value that the server would refuse for what it is, is no value. `width` and `height` are no words of
// a link: the window says how large the picture is.

const number = (value) => String(Number(Number(value).toPrecision(15)));
const numbers = (values) => values.map(number).join(',');

const plainNumber = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const shortName = /^[A-Za-z0-9._-]{1,64}$/;
const columnName = /^\P{Cc}{1,256}$/u; // the file's own word
const parameterName = /^[A-Za-z0-9]{1,64}$/;
const hexColor = /^#?[0-9a-f]{6}$/i;
const byIntensity = '*intensity';
const dusk = '3a424e,16191e';
const mostClasses = 256;
const farthest = 1e12;

const readNumber = (text) => (plainNumber.test(text) && Number.isFinite(Number(text)) ? Number(text) : undefined);

function readNumbers(text, count) {
  const values = text.split(',').map(readNumber);
  const fits = (count === undefined || values.length === count) && !values.includes(undefined);
  return fits ? values : undefined;
}

const withHash = (text) => (text.startsWith('#') ? text : `#${text}`).toLowerCase();

// Kinds of values, each { read(text) → value or undefined, print(value) }.

const numeric = (low, high) => ({
  read(text) {
    const value = readNumber(text);
    return value >= low && value <= high ? value : undefined;
  },
  print: number,
});
const whole = (low, high) => ({
  read(text) {
    const value = numeric(low, high).read(text);
    return Number.isInteger(value) ? value : undefined;
  },
  print: number,
});
const tuple = (count, isGood = (_values) => true) => ({
  read(text) {
    const values = readNumbers(text, count);
    return values?.every((value) => Math.abs(value) <= farthest) && isGood(values) ? values : undefined;
  },
  print: numbers,
});
const named = { read: (text) => (shortName.test(text) ? text : undefined), print: String };
const oneOf = (...names) => ({ read: (text) => (names.includes(text) ? text : undefined), print: String });
const flag = { read: (text) => ({ true: true, false: false })[text], print: String };
const share = numeric(0, 1);
const length = numeric(1e-9, farthest);

const byColumn = 'column:';
/** The column that a colour comes from; undefined where it is none's. */
export const columnOf = (color) => (color?.startsWith(byColumn) ? color.slice(byColumn.length) : undefined);
export const colorOf = (column) => byColumn + column;

const color = {
  read(text) {
    const name = columnOf(text);
    if (name !== undefined) return columnName.test(name) ? text : undefined;
    const by = text.endsWith(byIntensity) ? byIntensity : '';
    const source = text.slice(0, text.length - by.length);
    if (hexColor.test(source)) return withHash(source) + by;
    return shortName.test(source) ? source + by : undefined;
  },
  print: (value) => value.replace(/^#/, ''),
};
const background = {
  read(text) {
    if (text === 'transparent') return text;
    const colors = text.split(',');
    if (colors.length > 2 || !colors.every((one) => hexColor.test(one))) return undefined;
    const spelled = colors.map(withHash);
    return spelled.length === 2 ? spelled : spelled[0];
  },
  print: (value) => [value].flat().join(',').replaceAll('#', ''),
};
const classes = {
  read(text) {
    if (text === 'none') return [];
    const values = text.split(',').map((one) => whole(0, 255).read(one));
    return values.length <= mostClasses && !values.includes(undefined) ? values : undefined;
  },
  print: (values) => (values.length > 0 ? numbers(values) : 'none'),
};
const box = {
  read(text) {
    const values = tuple(6, (at) => [0, 1, 2].every((axis) => at[axis] <= at[axis + 3])).read(text);
    return values && { min: values.slice(0, 3), max: values.slice(3) };
  },
  print: ({ min, max }) => numbers([...min, ...max]),
};

/** A box, turned or not, or a half-space: as the JSON view has them, all their parts said. */
function readShape(text) {
  const [, outside, kind, list] = /^(-?)(box|plane):(.*)$/.exec(text) ?? [];
  const values = list === undefined ? undefined : readNumbers(list);
  if (!values?.every((value) => Math.abs(value) <= farthest)) return undefined;
  const [at, by, turn] = [values.slice(0, 3), values.slice(3, 6), values.slice(6)];
  if (kind === 'plane') {
    const good = values.length === 6 && !outside && by.some((value) => value !== 0);
    return good ? { plane: { point: at, normal: by } } : undefined;
  }
  const good = [6, 7, 9].includes(values.length) && by.every((value) => value > 0) && turn.every((angle) => Math.abs(angle) <= 360);
  return good ? { box: { center: at, size: by, turn: [...turn, 0, 0, 0].slice(0, 3) }, keep: outside ? 'outside' : 'inside' } : undefined;
}

function printShape({ box: turned, plane, keep }) {
  if (plane) return `plane:${numbers([...plane.point, ...plane.normal])}`;
  const [yaw, ...others] = turned.turn ?? [0, 0, 0];
  const turn = others.some((angle) => angle !== 0) ? [yaw, ...others] : yaw === 0 ? [] : [yaw];
  return `${keep === 'outside' ? '-' : ''}box:${numbers([...turned.center, ...turned.size, ...turn])}`;
}

/** Several, with `;` between them. */
const listWord = (most, read, print) => ({
  read(text) {
    const values = text.split(';').map(read);
    return values.length <= most && !values.includes(undefined) ? values : undefined;
  },
  print: (values) => (values.length > 0 ? values.map(print).join(';') : 'auto'),
});

export const mostShapes = 8;
const shapes = listWord(mostShapes, readShape, printShape);


/** NAME:LOW..HIGH, one of the ends perhaps left out. */
function readFilter(text) {
  const [, name = '', low, high] = /^(.*):([^:]*?)\.\.([^:]*)$/s.exec(text) ?? [];
  const column = name.replaceAll('%3B', ';').replaceAll('%25', '%');
  const ends = Object.fromEntries(Object.entries({ low, high }).filter(([, end]) => end !== '').map(([key, end = '']) => [key, readNumber(end)]));
  const values = Object.values(ends);
  return columnName.test(column) && values.length > 0 && !values.includes(undefined) && !(ends.low > ends.high) ? { column, ...ends } : undefined;
}

const printFilter = ({ column, low, high }) =>
  `${column.replaceAll('%', '%25').replaceAll(';', '%3B')}:${[low, high].map((end) => (end === undefined || end === null ? '' : number(end))).join('..')}`;

export const mostFilters = 4;
const filters = listWord(mostFilters, readFilter, printFilter);

/** A cloud that is shown together with this one; `.` is this one itself. */
function readMember(text) {
  const [id, ...parts] = text.split(',');
  if (id !== '.' && !shortName.test(id)) return undefined;
  const member = { cloud: id };
  for (const part of parts) {
    const [key, ...values] = part.split(':');
    const shift = key === 'shift' && values.length === 3 ? tuple(3).read(values.join(',')) : undefined;
    if (shift) member.shift = shift;
    else if (key === 'tint' && values.length === 1 && hexColor.test(values[0])) member.tint = withHash(values[0]);
    else if (part === 'hidden') member.hidden = true;
    else return undefined;
  }
  return member;
}

const printMember = ({ cloud, shift, tint, hidden }) => [
  cloud, shift?.some((value) => value !== 0) && `shift:${shift.map(number).join(':')}`, tint && `tint:${tint.replace('#', '')}`, hidden && 'hidden',
].filter(Boolean).join(',');

export const mostMembers = 64;
const members = listWord(mostMembers, readMember, printMember);

const plain = (word, kind) => ({ word, at: [word], ...kind });
const open = (word, kind) => ({ ...plain(word, kind), auto: true });
/** Said only where it is not what the cloud has anyway. */
const rare = (row) => ({ ...row, rare: true });
const light = (name, kind) => rare({ word: `light.${name}`, at: ['light', name], ...kind });

/** All of a view but camera and parameters, in the order in which a person would say it. `auto`: may be null. */
const table = [
  plain('method', named), plain('color', color), plain('colormap', named),
  open('range', tuple(2, ([low, high]) => low < high)), open('shading', named),
  plain('mirrors', flag), plain('behindMirrors', flag), plain('background', background), open('detail', numeric(0, 1024)),
  rare(open('exposure', numeric(-3, 3))), rare(open('classes', classes)), rare(open('clip', box)), rare(open('clips', shapes)),
  rare(open('filter', filters)), rare(open('with', members)),
  light('ambient', share), light('headlight', share), light('sunlight', share), light('shine', share), light('shadow', share),
  { ...light('occlusion', share), auto: true },
  { ...light('sun', tuple(2, ([around, above]) => Math.abs(around) <= 360 && above >= 0 && above <= 90)), auto: true },
  rare(plain('outliers', oneOf('hide', 'show'))), rare(open('budget', whole(1, 2 ** 53))), rare(open('samples', whole(1, 64))),
  rare(plain('quality', whole(1, 100))), rare(plain('subsampling', oneOf('4:4:4', '4:2:2', '4:2:0'))),
];

/** The members of a view that are style: everything but camera and size. */
export const styleKeys = [...new Set(['method', 'param', ...table.map(({ at }) => at[0])])];

const valueAt = (view, at) => at.reduce((value, key) => value?.[key], view);
const equal = (a, b) => JSON.stringify(a) === JSON.stringify(b);

function cameraWords(camera) {
  const words = [];
  for (const word of ['eye', 'target', 'up', 'viewMatrix']) if (camera[word]) words.push([word, numbers(camera[word])]);
  words.push(['projection', camera.type]);
  if (camera.type === 'orthographic') words.push(['viewHeight', number(camera.viewHeight)]);
  else words.push(['fov', number(camera.fov)]);
  for (const word of ['near', 'far']) if (camera[word] > 0) words.push([word, number(camera[word])]);
  return words;
}

function parameterWords(param) {
  return Object.entries(param ?? {})
    .filter(([, value]) => value !== null)
    .map(([name, value]) => [`param.${name}`, typeof value === 'number' ? number(value) : String(value)]);
}

/**
 * [word, value] pairs, in the order in which a person would say them. `usual`, what the cloud has where nothing is said, tells
 * which of them need no saying, and which have to be said to be automatic; without it, all that is not null is said.
 */
export function wordsOf(view, usual = undefined) {
  const words = view.camera ? cameraWords(view.camera) : [];
  for (const row of table) {
    const value = valueAt(view, row.at) ?? null;
    const theirs = valueAt(usual, row.at) ?? null;
    const isUsual = usual !== undefined && equal(value, theirs);
    if (value !== null && !(row.rare && isUsual)) words.push([row.word, row.print(value)]);
    else if (value === null && theirs !== null && row.auto) words.push([row.word, 'auto']);
    else if (value === null && theirs !== null && row.word === 'background') words.push([row.word, dusk]);
    if (row.word === 'method') words.push(...parameterWords(view.param));
  }
  return words;
}

function readParameters(pairs) {
  const param = {};
  for (const [word, text] of pairs) {
    const key = word.startsWith('param.') ? word.slice('param.'.length) : '';
    if (!parameterName.test(key) || Object.hasOwn(param, key)) continue;
    if (text === 'true' || text === 'false') param[key] = text === 'true';
    else if (plainNumber.test(text)) {
      if (Number.isFinite(Number(text))) param[key] = Number(text);
    } else if (shortName.test(text)) param[key] = text;
  }
  return param;
}

/** The style in a Map of words: of each word that it understands, the member of the view. */
export function readStyle(pairs) {
  const style = {};
  for (const { word, at, auto, read } of table) {
    const text = pairs.get(word);
    if (text === undefined) continue;
    const value = auto && text === 'auto' ? null : read(text);
    if (value === undefined) continue;
    if (at.length === 1) style[word] = value;
    else style[at[0]] = { ...style[at[0]], [at[1]]: value };
  }
  const param = readParameters(pairs);
  if (style.method || Object.keys(param).length > 0) style.param = param;
  return style;
}

const cameraKinds = {
  eye: tuple(3), target: tuple(3), up: tuple(3), viewMatrix: tuple(16),
  projection: oneOf('perspective', 'orthographic'), fov: numeric(1e-6, 180 - 1e-6), viewHeight: length, near: length, far: length,
};

/** What a Map of words says of the camera, in the spelling of the JSON view; undefined for nothing, and for what is no camera. */
export function readCamera(pairs) {
  const camera = {};
  for (const [word, { read }] of Object.entries(cameraKinds)) {
    const text = pairs.get(word);
    if (text === undefined) continue;
    const value = ['near', 'far'].includes(word) && text === 'auto' ? null : read(text);
    // A camera of which a part cannot be read would look elsewhere than somebody meant.
    if (value === undefined) return undefined;
    camera[word === 'projection' ? 'type' : word] = value;
  }
  if (camera.eye && equal(camera.eye, camera.target)) return undefined;
  if (camera.viewMatrix && (camera.eye || camera.target || camera.up)) return undefined;
  return Object.keys(camera).length > 0 ? camera : undefined;
}

/** key=value&…, with commas, dots, colons and semicolons left readable. */
export const printQuery = (words) =>
  words
    .map(([word, value]) => `${encodeURIComponent(word)}=${encodeURIComponent(value).replace(/%2C/g, ',').replace(/%3A/g, ':').replace(/%3B/g, ';')}`)
    .join('&');

/** Where the full-quality picture of a view is to be had. */
export function snapshotUrl(cloud, view, width, height, format = 'png') {
  const words = [...wordsOf(view), ['width', String(width)], ['height', String(height)]];
  return `/api/v1/clouds/${encodeURIComponent(cloud)}/snapshot.${format}?${printQuery(words)}`;
}
