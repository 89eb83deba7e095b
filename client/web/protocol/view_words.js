// A view in the words of the protocol's one vocabulary: the snapshot's query, and behind the # of a link. Pure.
//
// A view here is what the page asks for: { camera, method, param, color, colormap, range, shading, mirrors,
// behindMirrors, background, detail } in the spelling of the JSON view; null leaves the choice to the server.

const number = (value) => String(Number(Number(value).toPrecision(12)));
const numbers = (values) => values.map(number).join(',');

/** [word, value] pairs, in the order in which a person would say them. */
export function wordsOf(view) {
  const words = [];
  const say = (word, value) => words.push([word, value]);
  const { camera } = view;
  if (camera) {
    say('eye', numbers(camera.eye));
    say('target', numbers(camera.target));
    say('up', numbers(camera.up));
    say('projection', camera.type);
    if (camera.type === 'orthographic') say('viewHeight', number(camera.viewHeight));
    else say('fov', number(camera.fov));
  }
  if (view.method) say('method', view.method);
  for (const [name, value] of Object.entries(view.param ?? {})) {
    if (value !== null) say(`param.${name}`, typeof value === 'number' ? number(value) : String(value));
  }
  if (view.color) say('color', view.color.replace('#', ''));
  if (view.colormap) say('colormap', view.colormap);
  if (view.range) say('range', numbers(view.range));
  if (view.shading) say('shading', view.shading);
  for (const word of ['mirrors', 'behindMirrors']) {
    if (typeof view[word] === 'boolean') say(word, String(view[word]));
  }
  if (view.background) {
    say('background', [view.background].flat().join(',').replaceAll('#', ''));
  }
  if (typeof view.detail === 'number') say('detail', number(view.detail));
  return words;
}

/** key=value&…, with commas, dots and colons left readable. */
export const printQuery = (words) =>
  words
    .map(([word, value]) => `${encodeURIComponent(word)}=${encodeURIComponent(value).replace(/%2C/g, ',')}`)
    .join('&');

/** Where the full-quality picture of a view is to be had. */
export function snapshotUrl(cloud, view, width, height, format = 'png') {
  const words = [...wordsOf(view), ['width', String(width)], ['height', String(height)]];
  return `/api/v1/clouds/${encodeURIComponent(cloud)}/snapshot.${format}?${printQuery(words)}`;
}
