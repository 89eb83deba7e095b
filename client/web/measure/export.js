// Measures as files: CSV, DXF (R12), GeoJSON. All in the scan's own coordinates, which CSV and DXF say; GeoJSON is WGS 84 by its
// definition (RFC 7946): where the scan's coordinates are another system's, the server has said where its points lie in that. Pure.

import { exactText, heightFactor, valueText, unitOf } from './units.js';
import { figureOf, kinds, valuesOf } from './values.js';

/** What a note is called where measures have their kind. */
const noteKind = 'Note';

/** EPSG codes of WGS 84 in degrees, without and with height. */
const wgs84 = [4326, 4979];
export const isWgs84 = (cloud) => wgs84.includes(Number(cloud?.crsEpsg));
/** Whether a server can say where in WGS 84 its points lie, as far as that is known before it is asked. */
export const hasSystem = (cloud) => Boolean(cloud?.crsEpsg || cloud?.crsWkt || cloud?.crs);

const mainOf = (measure, cloud) => valuesOf(measure, heightFactor(cloud))[0];
/** The scan's unit, whatever the page shows. */
const ownUnit = (cloud) => unitOf(cloud.crsUnit, undefined).name;
const placeOf = (cloud) => cloud.crsName || (cloud.crsEpsg ? `EPSG:${cloud.crsEpsg}` : '');

/** A field of CSV: quoted where it must be; what a spreadsheet would take for a formula is none. */
function field(text) {
  const plain = /^[=+\-@\t\r]/.test(text) && !Number.isFinite(Number(text)) ? `'${text}` : text;
  return /[",\n\r]/.test(plain) ? `"${plain.replaceAll('"', '""')}"` : plain;
}

const unitNameOf = ({ quantity }, own) => (quantity === 'angle' ? 'degree' : own && `${own}${{ area: 2, volume: 3 }[quantity] ?? ''}`);

/** One row for each point, with what it belongs to; `words`: the kinds' names. Notes (annotate/notes.js, as points) have two columns more. */
export function csvOf(list, cloud, words) {
  const hasNotes = list.some(({ note }) => note);
  const rows = [['name', 'kind', 'value', 'unit', 'point', 'x', 'y', 'z', 'step', 'crs', ...(hasNotes ? ['text', 'link'] : [])]];
  for (const measure of list) {
    const main = mainOf(measure, cloud);
    const { note } = measure;
    const head = [measure.name, note ? noteKind : words[measure.kind], main ? exactText(main.value) : '', main ? unitNameOf(main, ownUnit(cloud)) : ''];
    measure.points.forEach((point, i) => {
      rows.push([...head, String(i + 1), ...point.map(exactText), exactText(measure.step), placeOf(cloud), ...(hasNotes ? [note?.text ?? '', note?.link ?? ''] : [])]);
    });
  }
  return rows.map((row) => `${row.map(field).join(',')}\r\n`).join('');
}

/** In the letters of ASCII: others as AutoCAD writes them, "\U+00E4". Control characters would end a line, and are none. */
const ascii = (text) =>
  [...text].map((one) => {
    const code = one.codePointAt(0);
    if (code < 32 || code === 127) return ' ';
    return code < 127 ? one : `\\U+${code.toString(16).toUpperCase().padStart(4, '0')}`;
  }).join('');

/** A DXF of R12, which every CAD reads: three-dimensional polylines, points and texts, on a layer for each kind. */
export function dxfOf(list, cloud, kindWords, shownUnit) {
  const lines = /** @type {string[]} */ ([]);
  const say = (code, text) => lines.push(String(code), String(text));
  const at = (place) => place.forEach((one, axis) => say(10 * (axis + 1), exactText(one)));
  const layerOf = ({ kind, note }) => (note ? noteKind : kind).toUpperCase();
  const comment = (text) => say(999, ascii(text).slice(0, 250));
  comment(`Measured in the coordinates of the file${placeOf(cloud) && `: ${placeOf(cloud)}`}${ownUnit(cloud) && `, ${ownUnit(cloud)}`}`);
  for (const [code, text] of [[0, 'SECTION'], [2, 'HEADER'], [9, '$ACADVER'], [1, 'AC1009'], [0, 'ENDSEC']]) say(code, text);
  const layers = [...Object.keys(kinds), ...(list.some(({ note }) => note) ? [noteKind] : [])].map((kind) => kind.toUpperCase());
  for (const [code, text] of [[0, 'SECTION'], [2, 'TABLES'], [0, 'TABLE'], [2, 'LAYER'], [70, layers.length]]) say(code, text);
  layers.forEach((layer, i) => { for (const [code, text] of [[0, 'LAYER'], [2, layer], [70, 0], [62, i + 1], [6, 'CONTINUOUS']]) say(code, text); });
  for (const [code, text] of [[0, 'ENDTAB'], [0, 'ENDSEC'], [0, 'SECTION'], [2, 'ENTITIES']]) say(code, text);
  const polyline = (layer, points, closed) => {
    for (const [code, text] of [[0, 'POLYLINE'], [8, layer], [66, 1], [10, 0], [20, 0], [30, 0], [70, closed ? 9 : 8]]) say(code, text);
    for (const point of points) {
      for (const [code, text] of [[0, 'VERTEX'], [8, layer]]) say(code, text);
      at(point);
      say(70, 32);
    }
    for (const [code, text] of [[0, 'SEQEND'], [8, layer]]) say(code, text);
  };
  for (const measure of list) {
    const layer = layerOf(measure);
    const { points } = measure;
    const { label, lines: drawn } = figureOf(measure);
    if (points.length === 1 || measure.kind === 'circle' || kinds[measure.kind].fits) {
      for (const point of points) {
        for (const [code, text] of [[0, 'POINT'], [8, layer]]) say(code, text);
        at(point);
      }
    }
    if (measure.kind === 'circle' || (kinds[measure.kind].fits && measure.answer)) for (const line of drawn) polyline(layer, line.slice(0, -1), true);
    else if (points.length > 1 && !kinds[measure.kind].fits) polyline(layer, points, kinds[measure.kind].closed === true);
    const spread = Math.max(...[0, 1, 2].map((axis) => Math.max(...points.map((one) => one[axis])) - Math.min(...points.map((one) => one[axis]))));
    const main = mainOf(measure, cloud);
    const words = [measure.name || kindWords[measure.kind], main && valueText(main, shownUnit)].filter(Boolean).join(': ');
    for (const [code, text] of [[0, 'TEXT'], [8, layer]]) say(code, text);
    at(label);
    say(40, exactText(Number((spread > 0 ? spread / 20 : 0.1).toPrecision(3))));
    say(1, ascii(words).slice(0, 250));
  }
  for (const [code, text] of [[0, 'ENDSEC'], [0, 'EOF']]) say(code, text);
  return lines.map((line) => `${line}\r\n`).join('');
}

function geometryOf(kind, points) {
  if (points.length === 1) return { type: 'Point', coordinates: points[0] };
  if (kinds[kind].closed) return { type: 'Polygon', coordinates: [[...points, points[0]]] };
  return kind === 'circle' || kinds[kind].fits ? { type: 'MultiPoint', coordinates: points } : { type: 'LineString', coordinates: points };
}

/**
 * RFC 7946. `lonlat`: of each point of the list, in its order, [longitude, latitude]; without it the scan's coordinates are these (isWgs84()). Heights of
 * other systems are no third coordinate of WGS 84: they stand beside, as in the file. Lengths in degrees are none, and not written.
 */
export function geoJsonOf(list, lonlat = undefined) {
  let next = 0;
  const features = list.map(({ name, kind, note, points }) => {
    const places = lonlat ? lonlat.slice(next, next + points.length) : points;
    next += points.length;
    const about = note ? { name, kind: noteKind.toLowerCase(), ...note } : { name, kind };
    const heights = lonlat ? { heights: points.map(([, , z]) => z) } : {};
    return { type: 'Feature', properties: { ...about, ...heights }, geometry: geometryOf(kind, places) };
  });
  return `${JSON.stringify({ type: 'FeatureCollection', features }, undefined, 1)}\n`;
}
