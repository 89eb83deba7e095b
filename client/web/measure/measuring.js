// Measuring, put together: the hand on the picture, what is drawn over it, the card beside it, and where all that is kept (keeping.js).
// It comes when it is first used, or when an address, a file or this device has measures to show (page/page_tools.js).

import { deviceStore } from '../connection/stores.js';
import { putCard } from '../page/lazy_tools.js';
import { measure as words } from '../page/strings/measure.js';
import { usualUpAxis } from '../view/usual.js';
import { Answers } from './answers.js';
import { card } from './card.js';
import { axesText } from './coordinates.js';
import { Draft, moreOf } from './draft.js';
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

export class Measuring {
  #viewer;
  #page;
  #measures = new Measures();
  #marks;
  #panel;
  #reading;
  #hand; // what the hand does while it is measuring's
  #keeping;
  #isActive = false;
  #kind = 'distance';
  #unit = deviceStore.get(unitKey);
  #cloud; // whose measures these are
  #draft;
  #selected; // { id, index } of the measure that is open, and of a point of it
  #replaced; // { id, index } of a point that the next click moves
  #moved; // { id, points } while a point is being dragged

  /**
   * `page`: { overlays (messages), reading (whose hand it takes), hash() (the view as an address says it), changed() (hears that the address has
   * something new to say), active(isActive) }
   */
  constructor(viewer, page) {
    this.#viewer = viewer;
    this.#page = page;
    this.#reading = page.reading;
    putCard(card, words);
    this.#marks = new Marks(find('marks'), viewer);
    this.#hand = {
      click: (cursor) => this.#clicked(cursor),
      finish: () => this.#finish(),
      hover: (surface) => this.#hover(surface),
      drag: (dragged) => this.#drag(dragged),
      drop: (dragged) => this.#drop(dragged),
      let: () => this.#let(),
      select: (id, index) => this.#touched(id, index),
      key: (name) => this.#key(name),
    };
    this.#panel = new Panel({
      kind: (kind) => this.#setKind(kind), unit: (unit) => this.#setUnit(unit), finish: () => this.#finish(), takeBack: () => this.#takeBack(),
      cancel: () => this.#cancel(), undo: () => this.#measures.undo(), redo: () => this.#measures.redo(), select: (id) => this.#select(id),
      change: (id, changes) => this.#measures.change(id, changes), zoom: (id) => this.#zoom(id), copy: (id) => this.#copy(id),
      remove: (id) => this.#remove(id), again: (id, index) => this.#again(id, index), removePoint: (id, index) => this.#measures.removePoint(id, index),
      tell: (id, facts) => this.#tell(id, facts), close: () => this.activate(false),
    });
    this.#keeping = new Keeping(viewer, this.#measures, {
      overlays: page.overlays, hash: page.hash, unit: () => this.#shownUnit, setUnit: (unit) => this.#setUnit(unit), opened: ({ measures }) => measures.length > 0 && this.activate(true),
    });
    this.#measures.addEventListener('change', () => this.#changed());
    new Answers(viewer, this.#measures);
    viewer.addEventListener('cloud', ({ detail }) => this.#cloudShown(detail));
    if (viewer.cloud) this.#cloudShown(viewer.cloud);
  }

  get isActive() { return this.#isActive; }
  /** The project whose measures these are. */
  get keeping() { return this.#keeping; }

  /** Outlines that have been measured in plan, for what is asked of the points within: [{ name, points }]; of models with Y up there are none. */
  get outlines() { return this.#measures.list.filter(({ kind, up }) => kinds[kind].closed && up === 'z').map(({ name, points }) => ({ name, points })); }

  activate(isActive = !this.#isActive) {
    if (isActive === this.#isActive) return;
    if (!isActive) this.#cancel();
    this.#isActive = isActive;
    if (isActive) this.#reading.take(this.#hand);
    else this.#reading.give(this.#hand);
    find('measuring').hidden = !isActive;
    document.body.classList.toggle('measuring', isActive);
    this.#page.active(isActive);
    this.#replaced = undefined;
    if (!isActive) {
      this.#selected = undefined;
      this.#marks.point(undefined);
      document.body.classList.remove('aiming');
      find('picture').focus({ preventScroll: true, focusVisible: false });
    }
    this.#show();
    this.#showList();
  }

  // ---- whose measures these are, and where they are kept

  #cloudShown(cloud) {
    const isOther = cloud.id !== this.#cloud?.id;
    this.#cloud = cloud;
    if (isOther) {
      this.#draft = this.#selected = this.#replaced = this.#moved = undefined;
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
    this.#place(cursor);
  }

  /** How near to a point those are at first that a shape is fitted to: some spacings of the scan, and as far as a column is thick. */
  get #usualWithin() {
    const { factor } = unitOf(this.#cloud?.crsUnit, 'm');
    return Number(Math.max(10 * (this.#cloud?.spacing ?? 0), 0.25 / factor).toPrecision(2));
  }

  /** The next point, at the cursor. */
  async #place(cursor) {
    const draft = this.#draft ?? new Draft(this.#kind, usualUpAxis(this.#viewer.cloud), kinds[this.#kind].fits ? this.#usualWithin : undefined);
    if (!this.#cloud || !draft.takesMore) return;
    this.#draft = draft;
    this.#selected = undefined;
    const place = draft.add(this.#viewer.surfaceAt(cursor)?.point);
    this.#show();
    const found = await pickOr(this.#viewer, this.#page.overlays, cursor);
    if (draft !== this.#draft || !draft.places.includes(place)) return; // given up meanwhile
    draft.settle(place, found);
    if (found) {
      this.#reading.coordinates.exact(found.position, stepOf(found), cursor, found.cloud);
      this.#panel.say(words.said.point(draft.places.indexOf(place) + 1, axesText(found.position, stepOf(found))));
    }
    this.#settled();
  }

  /** A point, or a label, that is there already: the next point of what is being made, where there is such a thing. */
  #touched(id, index) {
    const measure = this.#measures.find(id);
    if (!this.#draft || index === undefined) {
      this.#select(id, index);
      return;
    }
    if (!measure || !this.#draft.takesMore) return;
    const step = [measure.step, measure.step, measure.step];
    this.#draft.settle(this.#draft.add(measure.points[index]), { position: measure.points[index], precision: step, ...measure.more });
    this.#settled();
  }

  #settled() {
    const draft = this.#draft;
    if (draft.places.length === 0) this.#draft = undefined;
    const measure = draft.measure;
    if (measure) {
      this.#draft = undefined;
      this.#add(measure);
    } else if (draft.closing && !draft.isPending) {
      draft.closing = false; // a point was clicked twice: more are needed
    }
    this.#show();
  }

  #add(measure) {
    const name = this.#measures.nameFor(words.kinds[measure.kind]);
    const id = this.#measures.add({ ...measure, name });
    if (id === undefined) {
      this.#page.overlays.toast(words.messages.tooMany, words.messages.tooManyDetail(mostMeasures));
      return;
    }
    this.#select(id);
    this.#panel.say(words.said.measured(name, this.#textOf(this.#measures.find(id)) || axesText(measure.points[0], measure.step)));
  }

  #finish() {
    const draft = this.#draft;
    if (!draft) return;
    if (draft.lacks > 0) {
      this.#page.overlays.toast(words.messages.tooFew(draft.lacks), '', 'done');
      return;
    }
    draft.closing = true;
    this.#settled();
  }

  #takeBack() {
    this.#draft?.removeLast();
    if (this.#draft?.places.length === 0) this.#draft = undefined;
    this.#show();
  }

  #cancel() {
    this.#draft = this.#replaced = undefined;
    this.#show();
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
      const selected = this.#isActive && known.id === this.#selected?.id;
      const text = this.#textOf(measure) || measure.name;
      return { measure, look: { key: `${selected} ${text} ${isMoved}`, selected, drawn: isMoved, text, leg, heights } };
    });
    const draft = this.#draftMark(leg, heights);
    find('marks').classList.toggle('drafting', draft !== undefined);
    this.#marks.show(draft ? [...marks, draft] : marks);
    const point = this.#selected?.index;
    for (const node of find('marks').querySelectorAll('.handle.chosen')) node.classList.remove('chosen');
    if (point !== undefined) find('marks').querySelector(`.handle.point[data-measure="${this.#selected.id}"][data-index="${point}"]`)?.classList.add('chosen');
    if (this.#isActive) this.#panel.showTask(this.#draft?.kind ?? this.#kind, this.#draft, this.#replaced?.index);
  }

  /** What is being made, with the place under the cursor as its next point. */
  #draftMark(leg, heights) {
    const draft = this.#draft;
    if (!draft || draft.points.length === 0) return undefined;
    const placed = draft.places.filter(({ at }) => at);
    const under = draft.takesMore && this.#reading.cursor ? this.#viewer.surfaceAt(this.#reading.cursor)?.point : undefined;
    const points = [...placed.map(({ at }) => at), ...(under ? [under] : [])];
    const measure = { id: 'draft', kind: draft.kind, up: draft.up, visible: true, points, step: 0.005 };
    const text = this.#textOf(measure);
    return { measure, look: { key: '', selected: false, drawn: true, pending: [...placed.map(({ pending }) => pending), true], text: text && `≈ ${text}`, leg, heights } };
  }

  #showList() {
    if (this.#isActive) this.#panel.showList(this.#measures, this.#selected?.id, this.#shownUnit);
  }

  #hover(surface) {
    this.#marks.point(surface?.point);
    if (this.#draft) this.#show();
  }

  // ---- keys

  /** Whether the key was of use. */
  #key(name) {
    const { id, index } = this.#selected ?? {};
    const acts = {
      Escape: () => (this.#draft || this.#replaced ? this.#cancel() : this.#selected ? this.#select(undefined) : this.activate(false)),
      Enter: () => this.#finish(), // also where nothing is to be ended: nobody who measures wants to fly off by it
      ' ': () => this.#clicked(this.#middle),
      Backspace: this.#draft ? () => this.#takeBack() : index !== undefined && (() => this.#measures.removePoint(id, index)),
      undo: this.#draft ? () => this.#takeBack() : this.#measures.canUndo && (() => this.#measures.undo()),
      redo: this.#measures.canRedo && (() => this.#measures.redo()),
    };
    const act = acts[name === 'Delete' ? 'Backspace' : name];
    if (!act) return false;
    act();
    document.body.classList.toggle('aiming', name === ' ');
    return true;
  }

  get #middle() {
    const { width, height } = this.#viewer.cssSize;
    return { x: width / 2, y: height / 2 };
  }
}
