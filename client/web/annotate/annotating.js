// Notes at points of the scan: a hand that places and moves them, what is drawn over the picture (marks.js draws it, as measures), and the
// card with their titles, texts and links. Who writes one sees it at once; it is kept with the project (measure/keeping.js).

import { axesText } from '../measure/coordinates.js';
import { stepOf } from '../measure/hand.js';
import { Marks } from '../measure/marks.js';
import { pickOr } from '../measure/picking.js';
import { zoomTo } from '../measure/zoom.js';
import { element } from '../page/parameter_fields.js';
import { annotate as words } from '../page/strings/annotate.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { card } from './card.js';
import { NoteList } from './note_list.js';
import { mostNotes, pointOf } from './notes.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

export class Annotating extends ToolCard {
  #viewer;
  #page;
  #notes;
  #marks;
  #list;
  #selected; // id of the one that is open
  #replaced; // id of one that the next click moves
  #moved; // { id, point } while one is being dragged
  #coming = 0; // of the points that are being looked up, the newest one's number
  #pending; // about where that is
  #points = new WeakMap(); // note → as it is drawn

  /**
   * `page`: { reading (whose the hand is), keeping (the project, whose notes these are), overlays (messages), active(isActive) }
   */
  constructor(viewer, page) {
    super({ card, words, ...page });
    this.#viewer = viewer;
    this.#page = page;
    this.#notes = page.keeping.notes;
    const root = element('div', { id: 'notes', className: 'over marks', ariaHidden: 'true' });
    find('marks').after(root);
    this.#marks = new Marks(root, viewer);
    let pressed; // id of the note whose label was
    root.addEventListener('pointerdown', ({ target }) => { pressed = target.closest('.label')?.dataset.measure; });
    page.reading.hand.watch(root);
    root.addEventListener('click', () => {
      const id = pressed;
      if (id === undefined || this.isActive) return; // the hand has it, then
      this.activate(true);
      this.#select(Number(id));
    });
    this.#list = new NoteList(this.#notes, {
      select: (id) => this.#select(id), again: (id) => this.#again(id), zoom: (id) => zoomTo(viewer, [this.#notes.find(id).point]), remove: (id) => this.#remove(id),
      save: () => page.keeping.save(), open: () => page.keeping.choose(),
    });
    this.#notes.addEventListener('change', () => this.#changed());
    viewer.addEventListener('cloud', () => this.#show());
    this.#changed();
  }

  opened(isActive) {
    this.#replaced = this.#pending = undefined;
    if (!isActive) {
      this.#selected = undefined;
      this.#marks.point(undefined);
    }
    this.#changed();
  }

  #changed() {
    if (this.#selected && !this.#notes.find(this.#selected)) this.#selected = undefined;
    if (this.#replaced && !this.#notes.find(this.#replaced)) this.#replaced = undefined;
    this.#show();
    if (this.isActive) this.#list.show({ selected: this.#selected, replaced: this.#replaced, cloud: this.#viewer.cloud });
  }

  #show() {
    const marks = this.#notes.list.filter(({ visible, id }) => visible || id === this.#selected).map((note) => {
      const isMoved = this.#moved?.id === note.id;
      const selected = this.isActive && note.id === this.#selected;
      const measured = isMoved ? pointOf({ ...note, point: this.#moved.point }) : this.#pointOf(note);
      return { measure: measured, look: { key: `${selected} ${note.name} ${isMoved} ${note.point}`, selected, drawn: isMoved, text: note.name } };
    });
    const pending = this.#pending && { measure: { id: 'draft', kind: 'point', points: [this.#pending] }, look: { key: '', drawn: true, pending: [true], text: '' } };
    this.#marks.show(pending ? [...marks, pending] : marks);
  }

  /** The same for the same note, so that its mark stays. */
  #pointOf(note) {
    if (!this.#points.has(note)) this.#points.set(note, pointOf(note));
    return this.#points.get(note);
  }

  #select(id) {
    this.#selected = id;
    this.#replaced = undefined;
    this.#changed();
  }

  #again(id) {
    this.#selected = this.#replaced = id;
    this.#changed();
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  #remove(id) {
    const { name } = this.#notes.find(id);
    this.#notes.remove(id);
    this.#list.say(words.said.removed(name));
  }

  /** The scan's point there; says why where there is none, or undefined where another one is wanted by now. */
  async #pick(cursor) {
    this.#coming += 1;
    const number = this.#coming;
    const found = await pickOr(this.#viewer, this.#page.overlays, cursor);
    if (found) this.#page.reading.coordinates.exact(found.position, stepOf(found), cursor);
    return number === this.#coming ? found : undefined;
  }

  async #add(cursor) {
    this.#pending = this.#viewer.surfaceAt(cursor)?.point;
    this.#show();
    const cloud = this.#viewer.cloud?.id;
    const found = await this.#pick(cursor);
    this.#pending = undefined;
    if (!found || !this.isActive || cloud !== this.#viewer.cloud?.id) {
      this.#show();
      return;
    }
    const name = this.#notes.nameFor(words.first);
    const id = this.#notes.add({ name, text: '', link: '', point: found.position, step: stepOf(found), visible: true });
    if (id === undefined) {
      this.#page.overlays.toast(words.messages.tooMany, words.messages.tooManyDetail(mostNotes));
      return;
    }
    this.#select(id);
    this.#list.say(words.said.placed(name, axesText(found.position, stepOf(found))));
    this.#list.edit(id);
  }

  async #move(id, cursor) {
    const note = this.#notes.find(id);
    const found = note && (await this.#pick(cursor));
    this.#moved = undefined;
    if (found && this.#notes.find(id) === note) this.#notes.change(id, { point: found.position, step: stepOf(found) });
    else this.#changed();
  }

  // ---- the hand, as Reading tells it

  click(cursor) {
    const id = this.#replaced;
    if (id === undefined) {
      this.#add(cursor);
      return;
    }
    this.#replaced = undefined;
    this.#move(id, cursor);
  }

  finish() {}

  hover(surface) { this.#marks.point(surface?.point); }

  drag({ id, cursor }) {
    const surface = this.#viewer.surfaceAt(cursor);
    if (!surface || !this.#notes.find(id)) return;
    this.#moved = { id, point: surface.point };
    this.#marks.point(surface.point);
    this.#show();
  }

  drop({ id, cursor }) { this.#move(id, cursor); }

  let() {
    this.#moved = undefined;
    this.#show();
  }

  select(id) { this.#select(id); }

  /** Whether the key was of use. */
  key(name) {
    const acts = {
      Escape: () => (this.#replaced || this.#selected ? this.#select(undefined) : this.activate(false)),
      Enter: () => {}, // nobody who writes a note wants to fly off by it
      ' ': () => this.click({ x: this.#viewer.cssSize.width / 2, y: this.#viewer.cssSize.height / 2 }),
      Delete: this.#selected && (() => this.#remove(this.#selected)),
      undo: this.#notes.canUndo && (() => this.#notes.undo()),
      redo: this.#notes.canRedo && (() => this.#notes.redo()),
    };
    const act = acts[name];
    if (!act) return false;
    act();
    document.body.classList.toggle('aiming', name === ' ');
    return true;
  }
}
