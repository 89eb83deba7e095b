// Filtering by values: the card with a histogram and two handles for each column that the scan keeps. What is shown is the view's own word `filter`,
// so the address, undo and links hold it, and the server does it; the same histogram carries the ends of the ramp where colours come from that column.

import { columnTitle, isOne, knowsColumns, unitOfColumn } from '../page/columns.js';
import { element } from '../page/parameter_fields.js';
import { filter as words } from '../page/strings/filter.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { colorOf, mostFilters } from '../protocol/view_words.js';
import { card } from './card.js';
import { reachOf, ValueSlider } from './value_slider.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
/** Columns that colours have names of their own for. */
const drawn = ['intensity', 'classification'];

/** What can be filtered by: the columns of `cloud`, and what is drawn of it, as far as something is known of their values. Pure. */
export function columnsFor(cloud) {
  const columns = cloud.columns ?? [];
  const others = (cloud.attributes ?? []).filter(({ name }) => drawn.includes(name) && !columns.some((one) => one.name === name));
  const { classes = [] } = cloud;
  return [...others.map((one) => ({ type: 'uint16', ...(one.name === 'classification' && classes.length > 0 ? { range: [Math.min(...classes), Math.max(...classes)] } : {}), ...one })), ...columns]
    .filter((column) => column.drawn !== false && !isOne(column.range) && reachOf(column));
}

/** The word with a column's two ends, null where they are open; null for no filter at all. Pure. */
export function filtered(word, column, [low, high]) {
  const own = { column, ...(low === null ? {} : { low }), ...(high === null ? {} : { high }) };
  const isOpen = low === null && high === null;
  const known = word ?? [];
  const next = known.some((one) => one.column === column)
    ? known.flatMap((one) => (one.column !== column ? [one] : isOpen ? [] : [own]))
    : isOpen ? known : [...known, own];
  return next.length > 0 ? next : null;
}

export class Filtering extends ToolCard {
  #viewer;
  #of = ''; // the cloud whose columns are listed
  #rows = []; // { column, slider, ramp, button }

  /** `page`: { active(isActive) hears of it } */
  constructor(viewer, { active }) {
    super({ card, words, active });
    this.#viewer = viewer;
    viewer.addEventListener('view', ({ detail }) => detail.by !== 'hand' && this.#show());
    viewer.addEventListener('cloud', () => this.#fill());
    find('filter-none').addEventListener('click', () => viewer.changeStyle({ filter: null }));
  }

  opened() { this.#fill(); }

  /** The columns of the cloud that is shown, with what the server tells of their values; asked for while the card is open, once for each state of it. */
  async #fill() {
    const { cloud, server } = this.#viewer;
    if (!this.isActive || !cloud) return;
    const of = `${cloud.id} ${cloud.revision} ${cloud.state}`;
    if (of === this.#of) {
      this.#show();
      return;
    }
    this.#of = of;
    this.#list(cloud);
    if (cloud.columns?.some(({ histogram }) => histogram)) return; // the list says all of it
    const told = await server.cloud(cloud.id).catch(() => undefined);
    if (told && this.#of === of) this.#list({ ...cloud, ...told });
  }

  #list(cloud) {
    this.#rows = knowsColumns(cloud) ? columnsFor(cloud).map((column) => this.#row(column, cloud)) : [];
    /** @type {any} */
    const active = document.activeElement;
    const focused = active?.closest?.('#filter-list') && active.ariaLabel;
    find('filter-list').replaceChildren(...this.#rows.map(({ node }) => node));
    if (focused) /** @type {any} */ ([...find('filter-list').querySelectorAll('input, button')].find((one) => one.ariaLabel === focused))?.focus({ preventScroll: true });
    this.#show();
  }

  #row(column, cloud) {
    const { name, description } = column;
    const title = columnTitle(name);
    const unit = unitOfColumn(column, cloud);
    const reach = reachOf(column);
    const color = drawn.includes(name) ? name : colorOf(name);
    const labels = (low, high, group, mayMeet) => ({ low, high, group, mayMeet, reset: words.reset, resetLabel: words.resetLabel(group) });
    const slider = new ValueSlider(column, reach, labels(words.low(title), words.high(title), title, true), (ends) => {
      this.#viewer.changeStyle({ filter: filtered(this.#viewer.view.filter, name, ends) });
    });
    const ramped = name === 'classification' ? undefined : new ValueSlider({ ...column, histogram: undefined }, reach, labels(words.low(words.rampOf(title)), words.high(words.rampOf(title)), words.rampOf(title), false), (ends) => {
      const [low, high] = ends.map((end, i) => end ?? this.#usualOf(column)[i]);
      if (ends.every((end) => end === null)) this.#viewer.changeStyle({ range: null });
      else if (low < high) this.#viewer.changeStyle({ range: [low, high] });
    });
    const button = element('button', { type: 'button', className: 'small', textContent: words.color, title: words.colorTip(title), ariaLabel: words.colorTip(title) });
    button.addEventListener('click', () => this.#viewer.changeStyle(this.#viewer.view.color === color ? { color: 'auto', range: null } : { color, range: null }));
    const ramp = ramped && element('div', { className: 'ramp', hidden: true }, element('span', { textContent: words.ramp }), ramped.node);
    const node = element('li', {},
      element('div', { className: 'head' }, element('h3', { textContent: unit ? `${title} (${unit})` : title, title: name }), button),
      ...(description && description !== title ? [element('p', { className: 'note', textContent: description })] : []), slider.node, ...(ramp ? [ramp] : []));
    return { column, color, slider, ramped, ramp, button, node };
  }

  /** The ends of its ramp when nobody chose others. */
  #usualOf({ usual, range, histogram }) { return usual ?? (histogram ? [histogram.low, histogram.high] : range); }

  #show() {
    if (!this.isActive) return;
    const { view, cloud, catalog } = this.#viewer;
    const word = view.filter ?? [];
    for (const { column, color, slider, ramped, ramp, button } of this.#rows) {
      const own = word.find((one) => one.column === column.name);
      const isColor = view.color === color || view.color === `${color}*intensity`;
      const range = view.range ?? this.#usualOf(column);
      const colors = isColor && ramped && catalog.ramps?.[view.colormap];
      const shown = colors ? { colors, range } : undefined;
      slider.show([own?.low ?? null, own?.high ?? null], shown);
      slider.disabled = !own && word.length >= mostFilters;
      button.setAttribute('aria-pressed', String(isColor));
      if (ramp) ramp.hidden = !shown;
      if (shown) ramped.show(view.range ?? [null, null], shown);
    }
    find('filter-none').disabled = word.length === 0;
    find('filter-state').textContent = this.#rows.length > 0 ? words.state(word.length, mostFilters) : cloud?.state === 'loading' ? words.waiting : words.nothing;
  }
}
