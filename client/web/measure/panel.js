// The card beside the tool rail while one measures: what is measured, what to do next, and the list of what has been. All of it
// is text and buttons, so it is the measurements' other face: for keys and for screen readers.

import { Choices } from '../page/choices.js';
import { focusOn, headOf, keyed, leavesByEscape } from '../page/cards/entries.js';
import { icon } from '../page/icons.js';
import { element } from '../page/parameter_fields.js';
import { measure as words } from '../page/strings/measure.js';
import { stepText } from './coordinates.js';
import { heightFactor, measuresLengths, placeText, unitOf, unitsFor, valueText } from './units.js';
import { bases, crossesItself, kinds, valuesOf } from './values.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const longestName = 120;
const touch = matchMedia('(pointer: coarse)');

const facts = (pairs) => element('dl', {}, ...pairs.flatMap(([term, text]) => [element('dt', { textContent: term }), element('dd', { textContent: text })]));

/** "Class: 6", "Colour: 199, 99, 68": what the scan says of a point. Pure. */
export function attributePairs(more = {}) {
  const textOf = (value) => (Array.isArray(value) ? value.map(textOf).join(', ') : typeof value === 'number' ? String(Number(value.toPrecision(6))) : String(value));
  return Object.entries(more)
    .filter(([, value]) => ['number', 'string', 'boolean'].includes(typeof value) || (Array.isArray(value) && value.every((one) => typeof one === 'number')))
    .map(([name, value]) => [words.attributes[name] ?? name, textOf(value)]);
}

export class Panel {
  #does;
  #kinds;
  #unit;
  #cloud;
  #open; // the measure whose row was open last

  /**
   * `does`: kind(kind), unit(unit), finish(), takeBack(), cancel(), undo(), redo(), select(id or undefined), change(id, changes), zoom(id),
   * copy(id), remove(id), again(id, index), removePoint(id, index), tell(id, facts).
   */
  constructor(does) {
    this.#does = does;
    this.#kinds = new Choices(find('measure-kinds'), (kind) => does.kind(kind));
    this.#unit = new Choices(find('measure-unit'), (unit) => does.unit(unit));
    for (const [id, act] of Object.entries({
      'measure-done': 'finish', 'measure-take-back': 'takeBack', 'measure-cancel': 'cancel', 'measure-undo': 'undo', 'measure-redo': 'redo',
    })) find(id).addEventListener('click', () => does[act]());
    find('measure-undo').append(icon('undo'));
    find('measure-redo').append(icon('redo'));
  }

  /** Another scan: what can be measured in it, in which units. */
  setCloud(cloud, kind, unit) {
    this.#cloud = cloud;
    const lengths = measuresLengths(cloud.crsUnit);
    this.#kinds.fill(Object.keys(kinds).map((value) => {
      const picture = icon(`kind${value[0].toUpperCase()}${value.slice(1)}`);
      const able = lengths || value === 'point';
      return { value, label: words.kinds[value], tip: words.kindTips[value], picture, disabled: !able, reason: able ? '' : words.onlyPoints };
    }));
    this.#kinds.show(kind);
    const units = unitsFor(cloud.crsUnit);
    find('measure-unit').hidden = units.length === 0;
    find('measure-no-unit').hidden = units.length > 0 || !lengths;
    this.#unit.fill(units.map((value) => ({ value, label: words.units[value] })));
    this.#unit.show(unit);
  }

  showKind(kind) {
    this.#kinds.show(kind);
  }

  showUnit(unit) {
    this.#unit.show(unit);
  }

  /** What to do next; `draft` is what is being made, `replaced` the index of a point that gets another place. */
  showTask(kind, draft, replaced) {
    const how = replaced === undefined ? words.how[kind](touch.matches) : words.again(replaced + 1, touch.matches);
    find('measure-how').textContent = draft && replaced === undefined && !touch.matches ? `${how} ${words.keys}` : how;
    find('measure-draft').hidden = !draft;
    if (draft) find('measure-done').disabled = draft.lacks > 0 || draft.closing;
  }

  /** For screen readers. */
  say(text) {
    find('measure-said').textContent = text;
  }

  showList(measures, selected, unit) {
    const { list } = measures;
    const focused = /** @type {HTMLElement} */ (document.activeElement)?.closest?.('#measure-list')
      && /** @type {HTMLElement} */ (document.activeElement).dataset.key;
    find('measure-none').hidden = list.length > 0;
    find('measure-list').hidden = list.length === 0;
    find('measure-undo').disabled = !measures.canUndo;
    find('measure-redo').disabled = !measures.canRedo;
    find('measure-list').replaceChildren(...list.map((one) => this.#row(one, one.id === selected, unit)));
    // All of what has been opened, or, where that is too much, its beginning.
    const opened = selected !== this.#open ? find('measure-list').querySelector('li:has([aria-expanded="true"])') : null;
    for (const part of [opened, opened?.querySelector('.head')]) part?.scrollIntoView({ block: 'nearest' });
    this.#open = selected;
    // What had the focus may be gone; then the next best has it, and never nothing.
    if (focused && !this.focus(focused)) (find('measure-list').querySelector('button') ?? find('close-measuring')).focus();
  }

  /** `key`: of a control in the list, such as "row-3". */
  focus(key) { return focusOn(find('measure-list'), key); }

  #row(measure, isOpen, unit) {
    const { id, visible } = measure;
    const does = this.#does;
    const [main] = valuesOf(measure, heightFactor(this.#cloud));
    const shown = unitOf(this.#cloud?.crsUnit, unit);
    const head = headOf(measure, isOpen, words, { show: (isShown) => does.change(id, { visible: isShown }), open: () => does.select(isOpen ? undefined : id) },
      element('b', { textContent: main ? valueText(main, shown) : '' }));
    const row = element('li', { className: visible ? '' : 'unshown' }, head);
    if (isOpen) {
      row.append(this.#details(measure, shown));
      row.addEventListener('keydown', (event) => {
        if (event.key !== 'Delete' || !(event.target instanceof HTMLButtonElement)) return;
        event.preventDefault();
        event.stopPropagation();
        does.remove(id);
      });
    }
    return row;
  }

  /** How the server is to compute it; lengths are in the scan's unit, as coordinates are. */
  #option({ id, kind, option, answer }) {
    const change = (value) => this.#does.change(id, { option: value });
    const number = element('input', { type: 'number', step: 'any', value: String(typeof option === 'number' ? option : answer?.base?.at?.[2] ?? '') });
    number.dataset.key = `number-${id}`;
    number.setAttribute('aria-label', kind === 'volume' ? words.baseHeight : words.within);
    number.addEventListener('change', () => Number.isFinite(number.valueAsNumber) && (kind === 'volume' || number.valueAsNumber > 0) && change(number.valueAsNumber));
    if (kinds[kind].fits) return element('label', { className: 'row' }, element('span', { textContent: words.within }), number);
    const chosen = typeof option === 'number' ? 'height' : option ?? 'lowest';
    const select = element('select', {}, ...[...bases, 'height'].map((value) => element('option', { value, textContent: words.bases[value], selected: value === chosen })));
    select.dataset.key = `base-${id}`;
    select.setAttribute('aria-label', words.base);
    number.hidden = chosen !== 'height';
    select.addEventListener('change', () => {
      if (select.value === 'height') change(Number(number.value) || 0);
      else change(select.value);
    });
    return element('div', { className: 'row' }, element('span', { textContent: words.base }), select, number);
  }

  #details(measure, shown) {
    const { id, kind, name, points, step, more } = measure;
    const does = this.#does;
    const field = element('input', { type: 'text', value: name, maxLength: longestName, autocomplete: 'off' });
    field.dataset.key = `name-${id}`;
    field.addEventListener('change', () => does.change(id, { name: field.value.trim() || name }));
    leavesByEscape(field, () => this.focus(`row-${id}`));
    const values = valuesOf(measure, heightFactor(this.#cloud));
    const notes = [];
    const { asks, closed } = kinds[kind];
    if (asks && !measure.answer) notes.push(measure.trouble === undefined ? words.asking : words.asked(measure.trouble));
    else if (values.length === 0 && kind !== 'point') notes.push(words.noValue);
    if (closed && crossesItself(points)) notes.push(words.crosses);
    const places = points.map((point, index) => {
      const again = keyed(`again-${id}-${index}`, { textContent: words.placeAgain, title: words.placeAgainLabel(index + 1), className: 'small' }, () => does.again(id, index));
      again.setAttribute('aria-label', words.placeAgainLabel(index + 1));
      const gone = keyed(`gone-${id}-${index}`, { textContent: words.removePoint, className: 'small' }, () => does.removePoint(id, index));
      gone.setAttribute('aria-label', words.removePointLabel(index + 1));
      const canGo = points.length > kinds[kind].least;
      return element('li', {}, element('span', { textContent: placeText(point, step) }), again, ...(canGo ? [gone] : []));
    });
    return element('div', { className: 'details' },
      element('label', { className: 'row' }, element('span', { textContent: words.name }), field),
      facts([...values.map((value) => [words.values[value.name], valueText(value, shown)]), ...attributePairs(more)]),
      ...(asks ? [this.#option(measure)] : []),
      ...notes.map((text) => element('p', { className: 'note warning', textContent: text })),
      element('ol', { ariaLabel: words.points }, ...places),
      element('p', { className: 'note', textContent: step > 0 ? words.step(stepText(step, this.#cloud ?? {})) : '' }),
      element('div', { className: 'buttons' },
        ...(asks && (measure.trouble !== undefined || measure.answer) ? [keyed(`ask-${id}`, { textContent: words.askAgain }, () => does.tell(id, { answer: undefined, trouble: undefined }))] : []),
        keyed(`zoom-${id}`, { textContent: words.zoom }, () => does.zoom(id)),
        keyed(`copy-${id}`, { textContent: words.copy }, () => does.copy(id)),
        keyed(`remove-${id}`, { textContent: words.remove }, () => does.remove(id))));
  }
}
