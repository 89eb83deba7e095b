// Clouds that are shown together: the card with a row for each - whether it is seen, its tint, how it is shifted - and those that can be added. What is
// shown is the view's own word `with`, so the address, undo and links hold it, and the server draws all of them into one picture.

import { counted } from '../page/strings.js';
import { focusOn, keyed } from '../page/cards/entries.js';
import { icon } from '../page/icons.js';
import { itself, membersOf, wordOf } from '../page/members.js';
import { element } from '../page/parameter_fields.js';
import { together as words } from '../page/strings/together.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { mostMembers } from '../protocol/view_words.js';
import { card } from './card.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const axes = ['X', 'Y', 'Z'];
const stepsFor = ({ crsUnit }) => [0.001, 0.01, 0.1, 1, 10].map((step) => (crsUnit === 'degree' ? step / 1e5 : step));
const mostListed = 30;
const byShapes = 'eyedome';
const searchedFrom = 8; // so many others are found without

/** Why a cloud cannot be shown together with this one; '' where it can. Pure. */
export function reasonAgainst(own, other) {
  if (other.state === 'failed') return words.reasons.failed;
  if (!other.bounds) return words.reasons.loading;
  const key = ['crsEpsg', 'crsName', 'crsUnit'].find((name) => own[name] && other[name]); // who says nothing is taken by the other's word
  return key && own[key] !== other[key] ? words.reasons.crs(other.crsName || `EPSG:${other.crsEpsg}`) : '';
}

/** How far two boxes are apart; 0 where they overlap. */
const gapOf = (a, b) => Math.hypot(...[0, 1, 2].map((axis) => Math.max(0, b.min[axis] - a.max[axis], a.min[axis] - b.max[axis])));

/** The clouds that can be added, the nearest first, and behind them those that cannot: [{ cloud, reason }]. Pure. */
export function othersOf(own, shown, { clouds, pending = [] }, search = '') {
  const wanted = search.trim().toLowerCase();
  return [...clouds, ...pending]
    .filter(({ id, title }) => id !== own.id && !shown.includes(id) && `${title ?? ''} ${id}`.toLowerCase().includes(wanted))
    .map((cloud) => ({ cloud, reason: reasonAgainst(own, cloud) }))
    .map((one) => ({ ...one, far: one.reason ? Infinity : gapOf(own.bounds, one.cloud.bounds) }))
    .sort((a, b) => (a.far === b.far ? 0 : a.far - b.far));
}

/** A coordinate of a shift, one step on; without the dust of binary fractions. Pure. */
export const stepped = (value, step) => Number((value + step).toPrecision(12));

export class Together extends ToolCard {
  #viewer;
  #open; // the cloud whose shift is open
  #step = 0.1;
  #rows = new Map(); // cloud → { node, show(member) }
  #listed = ''; // what the rows are of
  #offered = '';
  #isLit = false; // because it is coloured by cloud

  /** `active(isActive)` hears of it. */
  constructor(viewer, active) {
    super({ card, words, active });
    this.#viewer = viewer;
    viewer.addEventListener('view', ({ detail }) => detail.by !== 'hand' && this.#show());
    for (const name of ['cloud', 'clouds']) viewer.addEventListener(name, () => this.#show());
    const on = (id, act) => find(id).addEventListener('click', act);
    on('together-fit', () => viewer.showStandardView('fit'));
    on('together-none', () => this.#put([]));
    on('together-color', () => viewer.changeStyle(this.#colours(viewer.view.color !== 'cloud')));
    find('together-search').addEventListener('input', () => this.#showOthers());
  }

  opened() { this.#show(); }

  get #members() {
    const { view, cloud, catalog } = this.#viewer;
    return membersOf(view, cloud, catalog.clouds);
  }

  #put(members) {
    const word = wordOf(members);
    const isMeant = word !== null || this.#viewer.view.color !== 'cloud'; // colours that tell clouds apart mean nothing of one alone
    this.#viewer.changeStyle({ with: word, ...(isMeant ? {} : this.#colours(false)) });
  }

  /** Each in a colour of its own, or not: that alone shows no shapes, so it is lit by them, unless somebody chose how. */
  #colours(byCloud) {
    const { shading } = this.#viewer.view;
    const isOurs = byCloud ? (shading ?? 'auto') === 'auto' : this.#isLit && shading === byShapes;
    this.#isLit = byCloud && isOurs;
    return { color: byCloud ? 'cloud' : 'auto', range: null, ...(isOurs ? { shading: byCloud ? byShapes : null } : {}) };
  }

  #change(cloud, changes) {
    this.#put(this.#members.map((one) => (one.cloud === cloud ? { ...one, ...changes } : one)));
  }

  #add(id) {
    this.#put([...this.#members, { cloud: id }]);
  }

  #show() {
    if (!this.isActive || !this.#viewer.cloud) return;
    const members = this.#members;
    const listed = JSON.stringify([this.#viewer.cloud.id, members.map(({ cloud, name }) => [cloud, name]), this.#open]);
    if (listed !== this.#listed) {
      this.#listed = listed;
      const focused = /** @type {any} */ (document.activeElement)?.dataset?.key;
      this.#rows = new Map(members.map((one) => [one.cloud, this.#row(one)]));
      find('together-list').replaceChildren(...[...this.#rows.values()].map(({ node }) => node));
      if (focused && !focusOn(find('together-list'), focused)) find('close-together').focus();
    }
    for (const one of members) this.#rows.get(one.cloud).show(one);
    const { color } = this.#viewer.view;
    find('together-color').setAttribute('aria-pressed', String(color === 'cloud'));
    find('together-color').disabled = members.length < 2;
    find('together-none').disabled = wordOf(members) === null;
    this.#showOthers();
  }

  #row({ cloud, name }) {
    const isOpen = this.#open === cloud;
    const eye = keyed(`eye-${cloud}`, { className: 'eye', ariaLabel: words.show(name) }, () => this.#change(cloud, { hidden: eye.ariaPressed === 'true' }));
    const tint = element('input', { type: 'color', ariaLabel: words.tint(name) });
    tint.addEventListener('input', () => this.#change(cloud, { tint: tint.value }));
    const head = keyed(`row-${cloud}`, { className: 'name', ariaExpanded: String(isOpen) }, () => {
      this.#open = isOpen ? undefined : cloud;
      this.#show();
    });
    const said = element('b');
    head.append(element('span', { textContent: name }), said);
    const fields = isOpen ? axes.map((axis, i) => this.#axis(axis, i, cloud, name)) : [];
    const node = element('li', {}, element('div', { className: 'head' }, eye, tint, head));
    if (isOpen) node.append(this.#details(cloud, fields));
    return {
      node,
      show: ({ shift = [0, 0, 0], hidden = false, color, tint: own }) => {
        eye.replaceChildren(icon(hidden ? 'unshown' : 'shown'));
        eye.setAttribute('aria-pressed', String(!hidden));
        node.classList.toggle('unshown', hidden);
        const shown = own ?? (this.#viewer.view.color === 'cloud' ? color : '#ffffff');
        if (tint.value !== shown) tint.value = shown;
        said.textContent = shift.some((value) => value !== 0) ? `Δ ${shift.join(', ')}` : '';
        fields.forEach(({ input }, i) => { if (document.activeElement !== input || input.valueAsNumber !== shift[i]) input.value = String(shift[i]); });
      },
    };
  }

  #shiftBy(cloud, axis, step) {
    const { shift = [0, 0, 0] } = this.#members.find((one) => one.cloud === cloud);
    this.#change(cloud, { shift: shift.with(axis, stepped(shift[axis], step)) });
  }

  #axis(axis, i, cloud, name) {
    const input = element('input', { type: 'number', step: 'any', ariaLabel: words.axis(axis, name) });
    input.dataset.key = `shift-${i}-${cloud}`;
    input.addEventListener('change', () => {
      const { shift = [0, 0, 0] } = this.#members.find((one) => one.cloud === cloud);
      if (Number.isFinite(input.valueAsNumber)) this.#change(cloud, { shift: shift.with(i, input.valueAsNumber) });
      else input.value = String(shift[i]);
    });
    const node = element('div', { className: 'axis' }, element('span', { textContent: axis, ariaHidden: 'true' }),
      keyed(`less-${i}-${cloud}`, { textContent: '−', ariaLabel: words.less(axis, name) }, () => this.#shiftBy(cloud, i, -this.#step)), input,
      keyed(`more-${i}-${cloud}`, { textContent: '+', ariaLabel: words.more(axis, name) }, () => this.#shiftBy(cloud, i, this.#step)));
    return { node, input };
  }

  #details(cloud, fields) {
    const steps = stepsFor(this.#viewer.cloud);
    if (!steps.includes(this.#step)) [, , this.#step] = steps;
    const select = element('select', {}, ...steps.map((value) => element('option', { value: String(value), textContent: String(value), selected: value === this.#step })));
    select.addEventListener('change', () => { this.#step = Number(select.value); });
    const remove = cloud === itself ? [] : [keyed(`remove-${cloud}`, { textContent: words.remove }, () => this.#put(this.#members.filter((one) => one.cloud !== cloud)))];
    return element('div', { className: 'details' }, element('h3', { textContent: words.shift }), ...fields.map(({ node }) => node),
      element('label', { className: 'row' }, element('span', { textContent: words.step }), select),
      element('div', { className: 'buttons' }, keyed(`still-${cloud}`, { textContent: words.noShift }, () => this.#change(cloud, { shift: undefined })),
        keyed(`plain-${cloud}`, { textContent: words.noTint }, () => this.#change(cloud, { tint: undefined })), ...remove));
  }

  #showOthers() {
    const { cloud, catalog } = this.#viewer;
    if (!cloud) return;
    const shown = this.#members.map((one) => one.cloud);
    const all = othersOf(cloud, shown, catalog);
    find('together-search').hidden = all.length < searchedFrom;
    const found = othersOf(cloud, shown, catalog, find('together-search').value);
    const isFull = shown.length >= mostMembers;
    const offered = JSON.stringify([found.map(({ cloud: { id, title }, reason }) => [id, title, reason]), isFull]);
    if (offered === this.#offered) return;
    this.#offered = offered;
    const hadFocus = find('together-others').contains(document.activeElement);
    find('together-others').replaceChildren(...found.slice(0, mostListed).map(({ cloud: { id, title, points }, reason }) => {
      const name = title || id;
      const button = keyed(`add-${id}`, { className: 'name', disabled: Boolean(reason) || isFull }, () => this.#add(id));
      button.append(element('span', { textContent: reason ? name : `+ ${name}` }), element('small', { textContent: reason || (points > 0 ? counted(points, 'point') : '') }));
      return element('li', {}, button);
    }));
    find('together-state').textContent = isFull ? words.most(mostMembers) : found.length > mostListed ? words.left(found.length - mostListed) : found.length > 0 ? '' : all.length > 0 ? words.notFound : words.noOthers;
    if (hadFocus) (find('together-others').querySelector('button:not(:disabled)') ?? find('close-together')).focus({ preventScroll: true });
  }
}
