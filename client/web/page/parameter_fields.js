// The fields for one method's parameters, made from what the server says of them: a slider with a number for numbers, a
// box for yes or no, a menu for choices.

import { NumberField, outside } from './number_field.js';
import { strings } from './strings.js';

/** Sliders are even in what the eye sees as even: in the logarithm for factors, finer near the start for long ranges. */
export function sliderScale({ min, max }) {
  const span = max - min;
  if (!(span > 0)) return { toValue: () => min, toSlider: () => 0 };
  const within = (t) => Math.min(1, Math.max(0, t));
  if (min > 0 && max / min >= 100) {
    const ratio = Math.log(max / min);
    return {
      toValue: (t) => min * Math.exp(ratio * within(t)),
      toSlider: (value) => within(Math.log(Math.max(value, min) / min) / ratio),
    };
  }
  const power = span > 40 ? 3 : 1;
  return {
    toValue: (t) => min + span * within(t) ** power,
    toSlider: (value) => within((value - min) / span) ** (1 / power),
  };
}

/** Three significant digits are what a hand on a slider means. */
export const rounded = (value) => Number(Number(value).toPrecision(value >= 100 ? 3 : 2));

/** What a parameter is called: by the page's own word for it, or by its name taken apart: "edgeWidthPx" in px is "Edge width". Pure. */
export function labelOf({ name, unit }) {
  if (Object.hasOwn(strings.parameters, name)) return strings.parameters[name];
  const words = name.replace(/([a-z0-9])([A-Z])/g, '$1 $2').toLowerCase();
  const bare = unit && words.endsWith(` ${unit.toLowerCase()}`) ? words.slice(0, -unit.length - 1) : words;
  return bare.charAt(0).toUpperCase() + bare.slice(1);
}

export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  Object.assign(made, properties);
  made.append(...children);
  return made;
}

function numberField(parameter, id, change) {
  const scale = sliderScale(parameter);
  const slider = element('input', { type: 'range', min: 0, max: 1, step: 0.002 });
  slider.setAttribute('aria-label', labelOf(parameter));
  const input = element('input', { type: 'number', id, min: parameter.min, max: parameter.max, step: 'any' });
  slider.addEventListener('input', () => {
    input.value = rounded(scale.toValue(slider.valueAsNumber));
    change(input.valueAsNumber);
  });
  // An empty field is the method's own value.
  const judge = (value) => (Number.isNaN(value) ? '' : outside(value, parameter));
  const field = new NumberField(input, judge, (typed) => {
    const value = Number.isNaN(typed) ? parameter.default : typed;
    input.value = value;
    slider.value = scale.toSlider(value);
    change(value);
  });
  const show = (value) => {
    field.show(value);
    // Not under the hands of somebody who is using it.
    if (document.activeElement !== slider) slider.value = scale.toSlider(value);
  };
  const unit = element('span', { className: 'unit', textContent: parameter.unit ?? '' });
  return { node: element('div', { className: 'row number' }, slider, input, unit), refusal: field.note, show };
}

function choiceField(parameter, id, change) {
  const select = element('select', { id });
  for (const choice of parameter.choices ?? []) select.append(new Option(choice, choice));
  select.addEventListener('change', () => change(select.value));
  return { node: select, show: (value) => { select.value = value; } };
}

function booleanField(parameter, id, change) {
  const box = element('input', { type: 'checkbox', id });
  box.addEventListener('change', () => change(box.checked));
  return { node: box, show: (value) => { box.checked = value === true; } };
}

const makers = { number: numberField, choice: choiceField, boolean: booleanField };

/** Fields for `parameters`; `change(name, value)` hears of every touch. `show(values)` fills them in. */
export function parameterFields(parameters, change) {
  const shows = [];
  const nodes = [];
  for (const parameter of parameters) {
    const make = makers[parameter.type];
    if (!make) continue;
    const id = `parameter-${parameter.name}`;
    const field = make(parameter, id, (value) => change(parameter.name, value));
    const meaning = parameter.meaning ?? '';
    const label = element('label', { htmlFor: id, textContent: labelOf(parameter) });
    const note = element('p', { className: 'note', textContent: meaning });
    const parts = [label, field.node, field.refusal, note].filter(Boolean);
    nodes.push(element('div', { className: `parameter ${parameter.type}`, title: meaning }, ...parts));
    shows.push((values) => field.show(values[parameter.name] ?? parameter.default));
  }
  return { nodes, show: (values) => shows.forEach((show) => show(values ?? {})) };
}
