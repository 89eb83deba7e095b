// Measuring, put together: the hand on the picture, what is drawn over it, the card beside it, and where all that is kept (keeping.js).
// It comes when it is first used, or when an address, a file or this device has measures to show (page/page_tools.js).

import { deviceStore } from '../connection/stores.js';
import { measure as words } from '../page/strings/measure.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { usualUpAxis } from '../view/usual.js';
import { Answers } from './answers.js';
import { card } from './card.js';
import { axesText } from './coordinates.js';
import { Draft, moreOf } from './draft.js';
import { Drawing } from './drawing.js';
import { stepOf } from './hand.js';
import { Keeping } from './keeping.js';
import { Marks } from './marks.js';
import { Measures, mostMeasures } from './measures.js';
import { Panel } from './panel.js';
import { pickOr } from './picking.js';
import { exactText, heightFactor, measuresLengths, unitOf, unitsFor, valueText } from './units.js';
import { kinds, valuesOf } from './values.js';
import { zoomTo } from './zoom.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const unitKey = 'scancast.unit';

export class Measuring extends ToolCard {
  #viewer;
  #page;
  #measures = new Measures();
  #marks;
  #panel;
  #reading;
  #hand; // what the hand does while it is measuring's
  #keeping;
  #kind = 'distance';
  #unit = deviceStore.get(unitKey);
  #cloud; // whose measures these are
  #drawing; // of the next one
  #selected; // { id, index } of the measure that is open, and of a point of it
  #replaced; // { id, index } of a point that the next click moves
  #moved; // { id, points } while a point is being dragged

  /**
   * `page`: { overlays (messages), reading (whose hand it takes), hash() (the view as an address says it), changed() (hears that the address has
   * something new to say), active(isActive) }
   */
  constructor(viewer, page) {
    super({ card, words, ...page });
    this.#viewer = viewer;
    this.#page = page;
    this.#reading = page.reading;
    this.#marks = new Marks(find('marks'), viewer);
    this.#drawing = new Drawing(viewer, page, {
      begin: () => this.#begin(), made: (measure) => this.#add(measure), show: () => this.#show(),
      found: (found, index) => this.#panel.say(words.said.point(index + 1, axesText(found.position, stepOf(found)))),
    });
    this.#hand = {
      click: (cursor) => this.#clicked(cursor),
      finish: () => this.#drawing.finish(),
      hover: (surface) => this.#hover(surface),
      drag: (dragged) => this.#drag(dragged),
      drop: (dragged) => this.#drop(dragged),
      let: () => this.#let(),
      select: (id, index) => this.#touched(id, index),
      key: (name) => this.#key(name),
    };
    this.#panel = new Panel({
      kind: (kind) => this.#setKind(kind), unit: (unit) => this.#setUnit(unit), finish: () => this.#drawing.finish(), takeBack: () => this.#drawing.takeBack(),
      cancel: () => this.#cancel(), undo: () => this.#measures.undo(), redo: () => this.#measures.redo(), select: (id) => this.#select(id),
      change: (id, changes) => this.#measures.change(id, changes), zoom: (id) => this.#zoom(id), copy: (id) => this.#copy(id),
      remove: (id) => this.#remove(id), again: (id, index) => this.#again(id, index), removePoint: (id, index) => this.#measures.removePoint(id, index),
      tell: (id, facts) => this.#tell(id, facts),
    });
    this.#keeping = new Keeping(viewer, this.#measures, {
      overlays: page.overlays, hash: page.hash, unit: () => this.#shownUnit, setUnit: (unit) => this.#setUnit(unit), opened: ({ measures }) => measures.length > 0 && this.activate(true),
    });
    this.#measures.addEventListener('change', () => this.#changed());
    new Answers(viewer, this.#measures);
    viewer.addEventListener('cloud', ({ detail }) => this.#cloudShown(detail));
    if (viewer.cloud) this.#cloudShown(viewer.cloud);
  }

  get hand() { return this.#hand; }
  /** The project whose measures these are. */
  get keeping() { return this.#keeping; }

  /** Outlines that have been measured in plan, for what is asked of the points within: [{ name, points }]; of models with Y up there are none. */
  get outlines() { return this.#measures.list.filter(({ kind, up }) => kinds[kind].closed && up === 'z').map(({ name, points }) => ({ name, points })); }

  opened(isActive) {
    this.#cancel();
    if (!isActive) {
      this.#selected = undefined;
      this.#marks.point(undefined);
    }
    this.#show();
    this.#showList();
  }

  // ---- whose measures these are, and where they are kept

  #cloudShown(cloud) {
    const isOther = cloud.id !== this.#cloud?.id;
    this.#cloud = cloud;
    if (isOther) {
      this.#selected = this.#replaced = this.#moved = undefined;
      this.#drawing.cancel();
      if (!measuresLengths(cloud.crsUnit)) this.#kind = 'point';
    }
    this.#panel.setCloud(cloud, this.#kind, this.#shownUnit);
    this.#keeping.show(cloud);
    this.#show();
    this.#showList();
  }

  /** An address that somebody has been given: its measures come to those that are here. */
  arrived(hash) {
    this.#keeping.arrived(hash);
  }

  /** A project file that was dropped onto the page. */
  open(file) {
    return this.#keeping.open(file);
  }

  /** '' or '&measures=…', for an address that has that many characters already. */
  hashPart(taken) {
    return this.#keeping.hashPart(taken);
  }

  #changed() {
    if (this.#selected && !this.#measures.find(this.#selected.id)) this.#selected = undefined;
    if (this.#replaced && !this.#measures.find(this.#replaced.id)) this.#replaced = undefined;
    this.#show();
    this.#showList();
    this.#page.changed();
  }

  // ---- what is measured

  get #shownUnit() {
    const units = unitsFor(this.#cloud?.crsUnit);
    return units.includes(this.#unit) ? this.#unit : units[0];
  }

  #setUnit(unit) {
    this.#unit = unit;
    deviceStore.set(unitKey, unit);
    this.#panel.showUnit(unit);
    this.#show();
    this.#showList();
  }

  #setKind(kind) {
    this.#cancel();
    this.#kind = kind;
    this.#select(undefined);
  }

  #clicked(cursor) {
    if (this.#replaced) {
      const { id, index } = this.#replaced;
      this.#replaced = undefined;
      this.#movePoint({ id, index, cursor });
      return;
    }
    this.#selected = undefined;
    this.#drawing.place(cursor);
  }

  /** How near to a point those are at first that a shape is fitted to: some spacings of the scan, and as far as a column is thick. */
  get #usualWithin() {
    const { factor } = unitOf(this.#cloud?.crsUnit, 'm');
    return Number(Math.max(10 * (this.#cloud?.spacing ?? 0), 0.25 / factor).toPrecision(2));
  }

  #begin() {
    if (!this.#cloud) return undefined;
    return new Draft(this.#kind, usualUpAxis(this.#viewer.cloud), kinds[this.#kind].fits ? this.#usualWithin : undefined);
  }

  /** A point, or a label, that is there already: the next point of what is being made, where there is such a thing. */
  #touched(id, index) {
    const measure = this.#measures.find(id);
    if (!this.#drawing.draft || index === undefined) {
      this.#select(id, index);
      return;
    }
    if (!measure) return;
    const step = [measure.step, measure.step, measure.step];
    this.#drawing.add({ position: measure.points[index], precision: step, ...measure.more });
  }

  #add(measure) {
    const name = this.#measures.nameFor(words.kinds[measure.kind]);
    const id = this.#measures.add({ ...measure, name });
    if (id === undefined) {
      this.#page.overlays.toast(words.messages.tooMany, words.messages.tooManyDetail(mostMeasures));
      return true;
    }
    this.#select(id);
    this.#panel.say(words.said.measured(name, this.#textOf(this.#measures.find(id)) || axesText(measure.points[0], measure.step)));
    return true;
  }

  #cancel() {
    this.#replaced = undefined;
    this.#drawing.cancel();
  }

  // ---- what has been measured

  #select(id, index = undefined) {
    this.#selected = id === undefined ? undefined : { id, index };
    this.#replaced = undefined;
    this.#show();
    this.#showList();
  }

  #drag({ id, index, isNew, cursor }) {
    const measure = this.#measures.find(id);
    const surface = this.#viewer.surfaceAt(cursor);
    if (!measure || !surface) return;
    this.#moved = { id, points: measure.points.toSpliced(index, isNew ? 0 : 1, surface.point) };
    this.#marks.point(surface.point);
    this.#show();
  }

  #let() {
    this.#moved = undefined;
    this.#show();
  }

  async #drop(dragged) {
    await this.#movePoint(dragged);
    this.#let();
  }

  /** Puts a point of a measure, or a new one, to the scan's point at the cursor. */
  async #movePoint({ id, index, isNew = false, cursor }) {
    const measure = this.#measures.find(id);
    const found = measure && (await pickOr(this.#viewer, this.#page.overlays, cursor));
    const now = this.#measures.find(id);
    if (!found || now !== measure) return;
    const step = stepOf(found);
    const points = measure.points.toSpliced(index, isNew ? 0 : 1, found.position);
    this.#moved = undefined;
    this.#measures.change(id, { points, step: Math.max(measure.points.length > 1 ? measure.step : 0, step), ...(measure.kind === 'point' ? { more: moreOf(found) } : {}) });
    this.#reading.coordinates.exact(found.position, step, cursor);
    this.#panel.say(words.said.point(index + 1, axesText(found.position, step)));
  }

  #again(id, index) {
    this.#cancel();
    this.#select(id, index);
    this.#replaced = { id, index };
    this.#show();
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  #tell(id, facts) {
    const measure = this.#measures.find(id);
    if (measure) this.#measures.tell(measure, facts);
  }

  #remove(id) {
    const name = this.#measures.find(id)?.name;
    this.#measures.remove(id);
    this.#panel.say(words.said.removed(name));
  }

  #zoom(id) {
    zoomTo(this.#viewer, this.#measures.find(id).points);
  }

  async #copy(id) {
    const measure = this.#measures.find(id);
    const text = [[measure.name, this.#textOf(measure)].filter(Boolean).join(': '), ...measure.points.map((point) => point.map(exactText).join(' '))].join('\n');
    try {
      await navigator.clipboard.writeText(text);
      this.#page.overlays.toast(words.messages.copied, text.split('\n')[0], 'done');
    } catch {
      this.#page.overlays.toast(words.messages.notCopied, text);
    }
  }

  #textOf(measure) {
    const [main] = valuesOf(measure, heightFactor(this.#cloud));
    return main ? valueText(main, unitOf(this.#cloud?.crsUnit, this.#shownUnit)) : '';
  }

  // ---- what is seen

  #show() {
    const shown = unitOf(this.#cloud?.crsUnit, this.#shownUnit);
    const heights = heightFactor(this.#cloud);
    const leg = (length) => valueText({ quantity: 'length', value: length, error: 0.005 / shown.factor }, shown);
    const marks = this.#measures.list.filter(({ visible, id }) => visible || id === this.#selected?.id).map((known) => {
      const isMoved = this.#moved?.id === known.id;
      const measure = isMoved ? { ...known, points: this.#moved.points } : known;
      const selected = this.isActive && known.id === this.#selected?.id;
      const text = this.#textOf(measure) || measure.name;
      return { measure, look: { key: `${selected} ${text} ${isMoved}`, selected, drawn: isMoved, text, leg, heights } };
    });
    const draft = this.#draftMark(leg, heights);
    find('marks').classList.toggle('drafting', draft !== undefined);
    this.#marks.show(draft ? [...marks, draft] : marks);
    const point = this.#selected?.index;
    for (const node of find('marks').querySelectorAll('.handle.chosen')) node.classList.remove('chosen');
    if (point !== undefined) find('marks').querySelector(`.handle.point[data-measure="${this.#selected.id}"][data-index="${point}"]`)?.classList.add('chosen');
    const { draft: made } = this.#drawing;
    if (this.isActive) this.#panel.showTask(made?.kind ?? this.#kind, made, this.#replaced?.index);
  }

  /** What is being made, with the place under the cursor as its next point. */
  #draftMark(leg, heights) {
    const { draft, shown } = this.#drawing;
    if (!shown || draft.points.length === 0) return undefined;
    const measure = { id: 'draft', kind: draft.kind, up: draft.up, visible: true, points: shown.points, step: 0.005 };
    const text = this.#textOf(measure);
    return { measure, look: { key: '', selected: false, drawn: true, pending: shown.pending, text: text && `≈ ${text}`, leg, heights } };
  }

  #showList() {
    if (this.isActive) this.#panel.showList(this.#measures, this.#selected?.id, this.#shownUnit);
  }

  #hover(surface) {
    this.#marks.point(surface?.point);
    if (this.#drawing.draft) this.#show();
  }

  // ---- keys

  /** Whether the key was of use. */
  #key(name) {
    const { id, index } = this.#selected ?? {};
    const drawing = this.#drawing;
    const acts = {
      Escape: () => (drawing.draft || this.#replaced ? this.#cancel() : this.#selected ? this.#select(undefined) : this.activate(false)),
      Enter: () => drawing.finish(), // also where nothing is to be ended: nobody who measures wants to fly off by it
      ' ': () => this.#clicked(drawing.middle),
      Backspace: drawing.draft ? () => drawing.takeBack() : index !== undefined && (() => this.#measures.removePoint(id, index)),
      undo: drawing.draft ? () => drawing.takeBack() : this.#measures.canUndo && (() => this.#measures.undo()),
      redo: this.#measures.canRedo && (() => this.#measures.redo()),
    };
    const act = acts[name === 'Delete' ? 'Backspace' : name];
    if (!act) return false;
    act();
    document.body.classList.toggle('aiming', name === ' ');
    return true;
  }
}
