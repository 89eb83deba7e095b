// Which part of a profile its panel shows, and where in it: { left, bottom } the station and the height in the lower left corner, `scale` px for
// a unit of station, `exaggeration` how many times as large heights are drawn. Pure; `size` is the plot's, in CSS pixels.

const farIn = 200; // px that a thousandth of the line may have at most
const farOut = 0.25; // of what fits

export const toPixel = ({ left, bottom, scale, exaggeration }, { height }, place) =>
  ({ x: (place.station - left) * scale, y: height - (place.height - bottom) * scale * exaggeration });

export const fromPixel = ({ left, bottom, scale, exaggeration }, { height }, { x, y }) =>
  ({ station: left + x / scale, height: bottom + (height - y) / (scale * exaggeration) });

/** What is seen: { left, right, bottom, top }. */
export function edgesOf(view, size) {
  const { station: right, height: top } = fromPixel(view, size, { x: size.width, y: 0 });
  return { left: view.left, right, bottom: view.bottom, top };
}

/** Exaggerations that one would say: 1, 2, 5, 10, …. */
export const exaggerations = [1, 2, 5, 10, 20, 50, 100];

/** The largest of them by which heights still fit where all stations do; 1 where none does. */
export function usualExaggeration(length, [low, high], { width, height }) {
  const fills = (height * length) / (width * Math.max(high - low, 1e-9));
  return exaggerations.findLast((one) => one <= fills) ?? 1;
}

/** All of it, in the middle. */
export function fitted(length, [low, high], size, exaggeration) {
  const range = Math.max(high - low, 1e-6 * length);
  const scale = Math.min(size.width / length, (0.94 * size.height) / (range * exaggeration));
  const spare = { station: size.width / scale - length, height: size.height / (scale * exaggeration) - range };
  return { left: -spare.station / 2, bottom: low - spare.height / 2, scale, exaggeration };
}

/** Nearer by `factor`, with what is under the cursor staying there. */
export function zoomed(view, size, cursor, factor, length) {
  const [least, most] = [(farOut * size.width) / length, (1000 * farIn) / length];
  const scale = Math.min(most, Math.max(least, view.scale * factor));
  const { station, height } = fromPixel(view, size, cursor);
  return { ...view, scale, left: station - cursor.x / scale, bottom: height - (size.height - cursor.y) / (scale * view.exaggeration) };
}

export const panned = (view, { x, y }) => ({ ...view, left: view.left - x / view.scale, bottom: view.bottom + y / (view.scale * view.exaggeration) });

/** The same place in the middle, with heights drawn that many times as large. */
export function exaggerated(view, size, exaggeration) {
  const { station, height } = fromPixel(view, size, { x: size.width / 2, y: size.height / 2 });
  return { ...view, exaggeration, left: station - size.width / 2 / view.scale, bottom: height - size.height / 2 / (view.scale * exaggeration) };
}

/** Round numbers between low and high, no more than `most`: { step, decimals, values }. */
export function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough * (1 - 1e-9)) ?? 10 * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) values.push(Number((i * step).toFixed(decimals)));
  return { step, decimals, values };
}

/** What two places of a profile are apart: { distance, along, rise, slope (degrees), percent }; `heights` as in measure/units.js. */
export function apart(a, b, heights = 1) {
  const along = Math.abs(b.station - a.station);
  const rise = b.height - a.height;
  const up = rise * heights;
  return { distance: Math.hypot(along, up), along, rise: up, slope: (Math.atan2(up, along) * 180) / Math.PI, percent: along > 0 ? (100 * up) / along : undefined };
}

/** The pixel nearest to [x, y] in which something is drawn, within `reach`; undefined for none. `data` as ImageData has it. */
export function nearestDrawn({ data, width, height }, x, y, reach) {
  let found;
  let least = (reach + 0.5) ** 2;
  for (let j = Math.max(0, Math.ceil(y - reach)); j <= Math.min(height - 1, y + reach); ++j) {
    for (let i = Math.max(0, Math.ceil(x - reach)); i <= Math.min(width - 1, x + reach); ++i) {
      const square = (i - x) ** 2 + (j - y) ** 2;
      if (square < least && data[4 * (j * width + i) + 3] > 0) [found, least] = [{ x: i, y: j }, square];
    }
  }
  return found;
}
