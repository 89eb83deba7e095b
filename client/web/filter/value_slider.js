// Two handles over the histogram of a column: the values between them. Each is a slider of the browser's own, so keys and screen readers work it;
// below stand the same two values as numbers. A handle at its end leaves that end open.

import { NumberField, rangeRefusal } from '../page/number_field.js';
import { element } from '../page/parameter_fields.js';
import { svg } from '../page/plan/svg.js';

const steps = 500;

/**
 * What two handles reach of a column: { low, high, step, whole }. Of whole numbers the ends lie half a number beyond, as its histogram's do, so that
 * a handle stands between two numbers. Undefined where nothing is known of its values. Pure.
 */
export function reachOf({ type = '', range, usual, histogram }) {
  const [low, high] = histogram ? [histogram.low, histogram.high] : usual ?? range ?? [];
  if (!Number.isFinite(low) || !Number.isFinite(high)) return undefined;
  const whole = /^u?int/.test(type) && [...(range ?? []), 2 * low, 2 * high].every(Number.isInteger);
  const half = whole && Number.isInteger(low) ? 0.5 : 0;
  const [from, to] = low < high || half ? [low - half, high + half] : [low - 0.5, high + 0.5];
  return { low: from, high: to, step: whole && to - from <= steps ? 1 : (to - from) / steps, whole };
}

/** The values between two handles, [low, high], null at an end that is open. Pure. */
export function valuesAt([from, to], { low, high, step, whole }) {
  const decimals = Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(high - low))));
  const plain = (value) => Number(value.toFixed(decimals));
  const near = step / 2;
  return [from <= low + near ? null : whole ? Math.ceil(from) : plain(from), to >= high - near ? null : whole ? Math.floor(to) : plain(to)];
}

/** Where the handles of these values stand. Pure. */
export function handlesAt([from, to], { low, high, whole }) {
  const within = (value) => Math.min(high, Math.max(low, value));
  const half = whole ? 0.5 : 0;
  return [from === null ? low : within(from - half), to === null ? high : within(to + half)];
}

/** How high each part of a histogram is drawn, 0 to 1. Roots, so that small ones are seen. Pure. */
export function heightsOf({ counts }) {
  const most = Math.max(1, ...counts);
  return counts.map((count) => Math.sqrt(count / most));
}

/** The colour of a value on a ramp between two ends. Pure. */
export const colorAt = (value, { colors, range: [low, high] }) =>
  colors[Math.round(Math.min(1, Math.max(0, (value - low) / (high - low || 1))) * (colors.length - 1))];

let made = 0;

export class ValueSlider {
  #reach;
  #sliders;
  #fields;
  #inputs;
  #reset;
  #bars;
  #picture;
  #taken = [null, null];
  node;

  /** `column`: as the API has it, with its histogram; `words`: { low, high, group, reset, resetLabel }; `change([low, high])` hears of every step. */
  constructor(column, reach, words, change) {
    made += 1;
    this.#reach = reach;
    const { histogram } = column;
    const heights = histogram ? heightsOf(histogram) : [];
    this.#bars = heights.map((height, i) => ({
      at: reach.low + ((i + 0.5) / heights.length) * (reach.high - reach.low),
      node: svg('rect', { x: i, y: (1 - height).toFixed(4), width: 0.96, height: height.toFixed(4) }),
    }));
    this.#picture = element('div', { className: 'spread', ariaHidden: 'true' });
    if (histogram) this.#picture.append(svg('svg', { viewBox: `0 0 ${heights.length} 1`, preserveAspectRatio: 'none' }, ...this.#bars.map(({ node }) => node)));
    const take = (values) => {
      this.show(values);
      change(values);
    };
    this.#sliders = [words.low, words.high].map((label, end) => {
      const slider = element('input', { type: 'range', min: String(reach.low), max: String(reach.high), step: String(reach.step), ariaLabel: label });
      slider.addEventListener('input', () => {
        const at = this.#sliders.map((one) => one.valueAsNumber);
        at[end] = end === 0 ? Math.min(at[0], at[1] - (reach.whole ? reach.step : 0)) : Math.max(at[1], at[0] + (reach.whole ? reach.step : 0));
        const values = valuesAt([at[0], at[1]], reach);
        take(end === 0 ? [values[0], this.#taken[1]] : [this.#taken[0], values[1]]); // what was typed at the other one stays
      });
      return slider;
    });
    this.#inputs = [words.low, words.high].map((label, end) => element('input', { type: 'number', step: 'any', id: `value-${made}-${end}`, ariaLabel: label, placeholder: String(Number((end === 0 ? Math.ceil : Math.floor)(1e6 * [reach.low, reach.high][end]) / 1e6)) }));
    if (reach.whole) this.#inputs.forEach((input, end) => { input.placeholder = String([Math.ceil(reach.low), Math.floor(reach.high)][end]); });
    const note = element('p', { className: 'refusal', id: `value-${made}-refusal` });
    this.#reset = element('button', { type: 'button', className: 'small', textContent: words.reset, ariaLabel: words.resetLabel });
    this.#reset.addEventListener('click', () => take([null, null]));
    const row = element('div', { className: 'row range' }, this.#inputs[0], element('span', { textContent: '–', ariaHidden: 'true' }), this.#inputs[1], this.#reset);
    const typed = () => this.#inputs.map((input) => (input.value === '' ? null : input.valueAsNumber));
    const why = () => {
      const ends = typed();
      return ends[0] !== null && ends[1] !== null && ends[0] === ends[1] && words.mayMeet ? '' : rangeRefusal(ends.map((end, i) => end ?? [-Infinity, Infinity][i]));
    };
    this.#fields = this.#inputs.map((input) => new NumberField(input, why, () => take(typed()), { note, group: row }));
    this.node = element('div', { className: 'values', role: 'group', ariaLabel: words.group }, this.#picture, element('div', { className: 'handles' }, ...this.#sliders), row, note);
  }

  /** [low, high], null where it is open; `ramp`, { colors, range }: what the values are coloured by. */
  show(values, ramp = undefined) {
    this.#taken = values;
    const { low, high } = this.#reach;
    const at = handlesAt(values, this.#reach);
    at.forEach((value, end) => {
      const slider = this.#sliders[end];
      slider.value = String(value);
      slider.setAttribute('aria-valuetext', values[end] === null ? this.#inputs[end].placeholder : String(values[end]));
      slider.classList.toggle('above', end === 0 && value > (low + high) / 2); // where both stand at the end, this one can be drawn
      this.#fields[end].show(values[end] ?? '');
    });
    for (const { at: value, node } of this.#bars) {
      node.classList.toggle('out', value < at[0] || value > at[1]);
      node.style.fill = ramp ? colorAt(value, ramp) : '';
    }
    if (ramp && this.#bars.length === 0) {
      const share = (value) => (100 * (value - low)) / (high - low);
      this.#picture.style.background = `linear-gradient(90deg, ${ramp.colors.map((color, i) => `${color} ${share(at[0]) + ((share(at[1]) - share(at[0])) * i) / Math.max(1, ramp.colors.length - 1)}%`).join(', ')})`;
    }
    this.#reset.disabled = values.every((value) => value === null);
  }

  set disabled(isDisabled) {
    for (const input of [...this.#sliders, ...this.#inputs]) input.disabled = isDisabled;
  }
}
