// What is known of the scan: its title and size over the picture, whose it is below - licences such as CC BY ask for that -, and
// everything else in the panel.

import { element } from './parameter_fields.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = strings.facts;
const longest = 500;

const textOf = (value) => (typeof value === 'string' ? value.trim().slice(0, longest) : '');

/** "200 × 200 × 33.8 m"; without the unit where the scan does not tell it. Pure. */
export function extentText({ min, max }, unit) {
  const extent = [0, 1, 2].map((i) => Number((max[i] - min[i]).toPrecision(3)).toLocaleString('en')).join(' × ');
  return [extent, words.units[unit]].filter(Boolean).join(' ');
}

/** "13 May 2024" of "2024-05-13", "May 2024" of "2024-05", "2024" of itself. Pure. */
export function dateText(date) {
  const [, year, month, day] = /^(\d{4})(?:-(\d{2})(?:-(\d{2}))?)?$/.exec(textOf(date)) ?? [];
  if (!month) return year ?? '';
  const at = new Date(Date.UTC(Number(year), Number(month) - 1, Number(day ?? 1)));
  return at.toLocaleDateString('en-GB', { ...(day ? { day: 'numeric' } : {}), month: 'long', year: 'numeric', timeZone: 'UTC' });
}

/** Whose the scan is, as the cloud file says it: "City of Graz, CC BY 4.0". Pure. */
export const creditOf = (cloud) => textOf(cloud.attribution);

/** The same behind its date, for a picture's margin. Pure. */
export const creditLine = (cloud) => [dateText(cloud.recorded), creditOf(cloud)].filter(Boolean).join(' · ');

/** [term, text] pairs, of what is known. Pure. */
export function factsOfScan(cloud) {
  const { names } = strings.colour;
  const spacing = cloud.spacing > 0 ? [Number(cloud.spacing.toPrecision(2)), words.units[cloud.crsUnit]].filter(Boolean).join(' ') : '';
  return [
    [words.points, cloud.points?.toLocaleString('en')],
    [words.extent, cloud.bounds && extentText(cloud.bounds, cloud.crsUnit)],
    [words.spacing, spacing],
    [words.attributes, (cloud.attributes ?? []).map(({ name }) => names[name] ?? name).join(', ')],
    [words.format, cloud.format],
    [words.crs, cloud.crsName],
    [words.recorded, dateText(cloud.recorded)],
    [words.attribution, creditOf(cloud)],
    [words.dropped, cloud.droppedPoints > 0 ? cloud.droppedPoints.toLocaleString('en') : ''],
    [words.notes, (cloud.notes ?? []).join(' ')],
  ].filter(([, text]) => text);
}

export function showScan(cloud) {
  const title = cloud.title || cloud.id;
  document.title = strings.app.titled(title);
  find('cloud-title').textContent = title;
  find('picture').setAttribute('aria-label', strings.app.pointCloudNamed(title));
  const date = dateText(cloud.recorded);
  const points = (cloud.state === 'loading' ? strings.app.pointsSoFar : strings.app.points)(cloud.points);
  const facts = [points, cloud.bounds && extentText(cloud.bounds, cloud.crsUnit), date || cloud.format?.split(',')[0]];
  find('cloud-facts').textContent = facts.filter(Boolean).join(' · ');
  const credit = creditOf(cloud);
  find('credit-title').textContent = title; // seen where the title is not: in presentations
  find('credit-date').textContent = date;
  find('credit-text').textContent = credit;
  find('credit').classList.toggle('empty', credit === '');
  find('about').hidden = false;
  find('scan-facts').replaceChildren(...factsOfScan(cloud).flatMap(([term, text]) => [
    element('dt', { textContent: term }), element('dd', { textContent: text }),
  ]));
}
