// Lengths and coordinates as a plan says them: round ones, in the unit that the scan's coordinate system names. Pure.

import { planStrings } from '../strings/plan.js';

/** Units that are parts or multiples of a metre: lengths in them are said in the one that suits their size. */
const metres = { millimetre: 0.001, metre: 1, meter: 1, kilometre: 1000 };
const feet = { foot: 'ft', 'us survey foot': 'ft (US)', degree: '°' };
/** @type {[number, string][]} from the largest on: metres, name */
const metric = [[1000, 'km'], [1, 'm'], [0.01, 'cm'], [0.001, 'mm']];

const known = (crsUnit) => String(crsUnit ?? '').toLowerCase();
const minus = (text) => text.replace(/^-(?=[0.,]*$)/, '').replace('-', '−');

/** What the scan's unit is called: "m", "ft (US)", "°"; where the scan does not tell it, "units" - or "unit", of one. */
export function unitName(crsUnit, count = 2) {
  const unit = known(crsUnit);
  const [, short] = metric.find(([size]) => size === metres[unit]) ?? [];
  return short ?? feet[unit] ?? (unit || planStrings.scale.units(count));
}

const decade = (length) => 10 ** Math.floor(Math.log10(length) + 1e-9);

/** The greatest of 1, 2 and 5 times a power of ten that is no more than that. */
export function roundBelow(most) {
  const power = decade(most);
  return (most >= 5 * power * (1 - 1e-9) ? 5 : most >= 2 * power * (1 - 1e-9) ? 2 : 1) * power;
}

/** The least of them that is no less. */
export function roundAbove(least) {
  const power = decade(least);
  const step = [1, 2, 5].find((one) => one * power >= least * (1 - 1e-9)) ?? 10;
  return step * power;
}

/** "20 cm", "1 km", "500 ft": a round length of the scan's unit. */
export function lengthText(length, crsUnit) {
  const size = metres[known(crsUnit)];
  if (!size) return `${Number(length.toPrecision(3)).toLocaleString('en', { maximumFractionDigits: 12 })} ${unitName(crsUnit, length)}`.replace(' °', '°');
  const inMetres = length * size;
  const [of, name] = metric.find(([one]) => inMetres >= one * (1 - 1e-9)) ?? metric.at(-1);
  return `${Number((inMetres / of).toPrecision(3)).toLocaleString('en', { maximumFractionDigits: 9 })} ${name}`;
}

/** Digits behind the point that tell values apart which lie that far from each other. */
export const decimalsFor = (step) => Math.min(12, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));

/** "389,450", "−12.5": a coordinate among others that are `step` apart. */
export function coordinateText(value, step) {
  const decimals = decimalsFor(step);
  return minus(value.toLocaleString('en', { minimumFractionDigits: decimals, maximumFractionDigits: decimals }));
}
