// What is known of the scan: its title and size over the picture, whose it is below - licences such as CC BY ask for that -, and
// everything else in the panel.

import { element } from './parameter_fields.js';
import { counted, strings } from './strings.js';

const find = (id) => document.getElementById(id);
const words = strings.facts;
const longest = 500;

const textOf = (value) => (typeof value === 'string' ? value.trim().slice(0, longest) : '');

/** "200 × 200 × 33.8 m"; without the unit where the scan does not tell it. Pure. */
export function extentText({ min, max }, unit) {
  const extent = [0, 1, 2].map((i) => Number((max[i] - min[i]).toPrecision(3)).toLocaleString('en')).join(' × ');
  return [extent, words.units[unit]].filter(Boolean).join(' ');
}

/** "12 May 2024" of "2024-05-12"; a year or a month alone stay what they are. Pure. */
export function dateText(date) {
  const said = textOf(date);
  if (!/^\d{4}-\d{2}-\d{2}/.test(said)) return said;
  const day = new Date(`${said.slice(0, 10)}T00:00:00Z`);
  return Number.isNaN(day.getTime()) ? '' : day.toLocaleDateString('en-GB', { day: 'numeric', month: 'long', year: 'numeric', timeZone: 'UTC' });
}

/** Whose the scan is: "Geoffrey Marchal · CC BY 4.0". Pure. */
export const creditOf = (cloud) => [textOf(cloud.attribution), textOf(cloud.licence ?? cloud.license)].filter(Boolean).join(' · ');

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
    [words.captured, dateText(cloud.captured)],
    [words.attribution, textOf(cloud.attribution)],
    [words.licence, textOf(cloud.licence ?? cloud.license)],
    [words.dropped, cloud.droppedPoints > 0 ? cloud.droppedPoints.toLocaleString('en') : ''],
    [words.notes, (cloud.notes ?? []).join(' ')],
  ].filter(([, text]) => text);
}

export function showScan(cloud) {
  const title = cloud.title || cloud.id;
  document.title = strings.app.titled(title);
  find('cloud-title').textContent = title;
  find('picture').setAttribute('aria-label', strings.app.pointCloudNamed(title));
  const date = dateText(cloud.captured);
  const facts = [counted(cloud.points, 'point'), cloud.bounds && extentText(cloud.bounds, cloud.crsUnit), date || cloud.format?.split(',')[0]];
  find('cloud-facts').textContent = facts.filter(Boolean).join(' · ');
  const credit = creditOf(cloud);
  find('credit-title').textContent = title; // seen where the title is not: in presentations
  find('credit-text').textContent = [date, credit].filter(Boolean).join(' · ');
  find('credit').classList.toggle('empty', credit === '');
  find('about').hidden = false;
  find('scan-facts').replaceChildren(...factsOfScan(cloud).flatMap(([term, text]) => [
    element('dt', { textContent: term }), element('dd', { textContent: text }),
  ]));
}
