// Numbers with their units, to as many digits as the coordinates are good for. Pure.

/** Units that a scan's coordinate system may name, in metres. */
const metres = { metre: 1, meter: 1, foot: 0.3048, 'us survey foot': 1200 / 3937 };
const known = (crsUnit) => String(crsUnit ?? '').toLowerCase();
const most = 4; // digits behind the point: a tenth of a millimetre

/** Whether lengths in that unit are lengths: degrees are not. */
export const measuresLengths = (crsUnit) => known(crsUnit) !== 'degree';

/** The units that lengths of such a scan can be shown in, its own first; none where it does not tell it. */
export function unitsFor(crsUnit) {
  const own = known(crsUnit);
  if (!Object.hasOwn(metres, own)) return [];
  return metres[own] === 1 ? ['m', 'ft'] : ['ft', 'm'];
}

/**
 * { factor, name }: by what lengths of the scan are multiplied to be in `shown` ('m', 'ft'), and what that is called. A foot is the
 * scan's own one, where it has one.
 */
export function unitOf(crsUnit, shown) {
  const own = known(crsUnit);
  if (!Object.hasOwn(metres, own)) return { factor: 1, name: '' };
  const isSurvey = own === 'us survey foot';
  if (shown === 'ft') return { factor: metres[own] === 1 ? 1 / metres.foot : 1, name: isSurvey ? 'ft (US)' : 'ft' };
  if (shown === 'm') return { factor: metres[own], name: 'm' };
  return unitOf(crsUnit, unitsFor(crsUnit)[0]);
}

/** What heights are multiplied by to be in the unit of x and y: 1, unless the scan says that z is in another one. */
export function heightFactor(cloud) {
  const [across, up] = [known(cloud?.crsUnit), known(cloud?.crs?.verticalUnit)];
  return Object.hasOwn(metres, across) && Object.hasOwn(metres, up) ? metres[up] / metres[across] : 1;
}

/** Digits behind the point that say something where `error` is left open. */
export const decimalsFor = (error) => (error > 0 ? Math.min(most, Math.max(0, Math.ceil(-Math.log10(2 * error)))) : most);

const digits = (value, decimals) =>
  value.toLocaleString('en', { minimumFractionDigits: decimals, maximumFractionDigits: decimals }).replace(/^-(?=[0.,]*$)/, '').replace('-', '−');

/** "12.345 m", "1,234.6 m²", "90.0°": a value of valuesOf() in that unit. */
export function valueText({ quantity, value, error }, { factor, name }) {
  if (quantity === 'count') return digits(value, 0);
  if (quantity === 'angle') return `${digits(value, Math.min(2, decimalsFor(error)))}°`;
  const power = { area: 2, volume: 3 }[quantity] ?? 1;
  const text = digits(value * factor ** power, decimalsFor(error * factor ** power));
  return name ? `${text} ${name}${['', '²', '³'][power - 1]}` : text;
}

/** "389,459.271  5,819,743.970  45.426" in the scan's own unit, whatever others are shown in. */
export const placeText = (point, step) => point.map((one) => digits(one, decimalsFor(step / 2))).join('  ');

/** A coordinate as it stands in the file, and no digit more. */
export const exactText = (number) => String(Number(number.toPrecision(15)));
