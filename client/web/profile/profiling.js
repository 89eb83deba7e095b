// Profiles, put together: a line that is drawn on the picture, the corridor around it, and the panel below that shows what the server finds in it. The line's
// points are the scan's own, as measures' are; what counts of the scan is what the view shows of it: classes, boxes.

import { mostShapes } from '../clip/box.js';
import { postSoon } from '../export/asking.js';
import { coloursOf, regionOf } from '../export/region.js';
import { sizeText } from '../export/sizes.js';
import { chooseTarget, downloadBlob, saveAnswer } from '../export/saving.js';
import { Draft } from '../measure/draft.js';
import { Drawing } from '../measure/drawing.js';
import { pickOr } from '../measure/picking.js';
import { measuresLengths, unitOf, valueText } from '../measure/units.js';
import { usualUpAxis } from '../view/usual.js';
import { ownShift } from '../page/members.js';
import { counted, strings } from '../page/strings.js';
import { profile as words } from '../page/strings/profile.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { isEmpty, partQuestion, pointSizeFor, pointsQuestion, toldBy, wholeQuestion } from './asking.js';
import { card } from './card.js';
import { boxesAround, lengthOf, lineOf, movedBy, placeAt } from './line.js';
import { LineMarks } from './line_marks.js';
import { ProfilePanel } from './panel.js';
import { plotSize } from './paint.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const touch = matchMedia('(pointer: coarse)');
const againMs = 250; // after the view shows other points

export class Profiling extends ToolCard {
  #viewer;
  #page;
  #marks;
  #panel;
  #hand;
  #cloud;
  #drawing; // of the next line
  #points = []; // of the line, where the scan's file has them: of one that is shifted, they are seen elsewhere (#seen)
  #step = 0;
  #width;
  #moved; // the same while one of them is being dragged
  #asking; // of the picture that is on its way
  #saving; // of the file that is
  #counted; // what the view shows of the scan, as it was asked for last
  #timer;

  /** `page`: { overlays, reading (whose hand it takes), active(isActive) } */
  constructor(viewer, page) {
    super({ card, words, ...page });
    this.#viewer = viewer;
    this.#page = page;
    this.#marks = new LineMarks(viewer);
    page.reading.hand.watch(this.#marks.root);
    const drawing = new Drawing(viewer, page, { begin: () => this.#begin(), made: (measure) => this.#made(measure), show: () => this.#show() });
    this.#drawing = drawing;
    this.#hand = {
      click: (cursor) => drawing.place(cursor), finish: () => drawing.finish(), hover: (surface) => this.#hover(surface), drag: (dragged) => this.#drag(dragged),
      drop: (dragged) => this.#drop(dragged), let: () => this.#let(), select: () => {}, key: (name) => this.#key(name),
    };
    this.#panel = new ProfilePanel({
      wants: (edges, view, ratio) => this.#askPart(edges, view, ratio), placeOf: (place) => [...placeAt(this.#line, place.station), place.height],
      hover: (place) => this.#marks.spot(place && this.#seen([[...placeAt(this.#line, place.station), place.height]])[0]),
      again: () => this.#again(), only: () => this.#only(), save: (format) => this.#save(format), mayExport: () => viewer.server.access.mayExport, stop: () => this.#saving?.abort(), close: () => this.close(),
    });
    const on = (id, act) => find(id).addEventListener('click', act);
    on('profile-done', () => drawing.finish());
    on('profile-take-back', () => drawing.takeBack());
    on('profile-cancel', () => this.#cancel());
    find('profile-width').addEventListener('change', () => this.#setWidth(find('profile-width').valueAsNumber));
    viewer.addEventListener('cloud', ({ detail }) => this.#cloudShown(detail));
    viewer.addEventListener('view', ({ detail }) => detail.by !== 'hand' && this.#viewChanged());
    if (viewer.cloud) this.#cloudShown(viewer.cloud);
  }

  get hand() { return this.#hand; }
  get #line() { return lineOf(this.#points); }
  get #profile() { return { line: this.#line, width: this.#width }; }
  get #shift() { return ownShift(this.#viewer.view) ?? [0, 0, 0]; }

  /** Points of the scan's file, where they are seen, and the other way round. */
  #seen(points) { return movedBy(points, this.#shift); }
  #inFile(points) { return movedBy(points, this.#shift.map((value) => -value)); }

  opened(isActive) {
    this.#cancel();
    if (!isActive) {
      this.#asking?.abort();
      this.#saving?.abort();
    }
    if (isActive && this.#points.length > 1) this.#draw();
    else this.#panel.show(false, this.#cloud);
  }

  #cloudShown(cloud) {
    const isOther = cloud.id !== this.#cloud?.id;
    this.#cloud = cloud;
    if (isOther) {
      this.#asking?.abort();
      this.#saving?.abort();
      this.#panel.plot.begin();
      this.#moved = undefined;
      this.#points = [];
      this.#drawing.cancel();
      // Some spacings of the scan, and as thick as a wall.
      const { factor } = unitOf(cloud.crsUnit, 'm');
      this.#width = Number(Math.max(6 * (cloud.spacing ?? 0), 0.5 / factor).toPrecision(1));
      find('profile-width').value = String(this.#width);
      find('profile-unit').textContent = unitOf(cloud.crsUnit, undefined).name;
      this.#panel.show(false, cloud);
    }
    else if (this.#panel.isOpen && !this.#panel.plot.view) this.#draw(); // the first picture had failed
    else this.#viewChanged(); // there may be more of it by now
    find('profile-only').hidden = !Object.hasOwn(cloud.view ?? {}, 'clips'); // an older server
    this.#show();
  }

  /** Other classes, other boxes, other colours: another picture. */
  #viewChanged() {
    if (this.#points.length > 0) this.#show(); // a shift moves the line with the scan
    if (!this.#panel.isOpen || this.#shownAs === this.#counted) return;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#panel.isOpen && this.#draw({ isSameLine: true }), againMs);
  }

  get #shownAs() {
    const { view } = this.#viewer;
    return JSON.stringify([coloursOf(view), regionOf(view), this.#cloud?.revision]);
  }

  #setWidth(width) {
    if (width > 0 && Number.isFinite(width)) this.#width = width;
    find('profile-width').value = String(this.#width);
    this.#show();
    if (this.#panel.isOpen) this.#draw({ isSameLine: true });
  }

  // ---- the line

  get #isUpright() { return !this.#cloud || usualUpAxis(this.#cloud) === 'z'; } // the server's profiles stand on x and y
  get #isAble() { return measuresLengths(this.#cloud?.crsUnit) && this.#isUpright; }

  #begin() {
    return this.#cloud && this.#isAble && this.#points.length === 0 ? new Draft('horizontal', 'z') : undefined;
  }

  /** Whether that is a line: points above each other are none. */
  #made({ points, step }) {
    const isLine = lengthOf(lineOf(points)) > 0;
    if (isLine) {
      this.#points = this.#inFile(points);
      this.#step = step;
      this.#draw();
    }
    return isLine;
  }

  #cancel() {
    this.#moved = undefined;
    this.#drawing.cancel();
  }

  #again() {
    this.#asking?.abort();
    this.#points = [];
    this.#panel.show(false, this.#cloud);
    this.#show();
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  #drag({ index, isNew, cursor }) {
    const surface = this.#viewer.surfaceAt(cursor);
    if (!surface || this.#drawing.draft) return;
    this.#moved = this.#points.toSpliced(index, isNew ? 0 : 1, ...this.#inFile([surface.point]));
    this.#show();
  }

  async #drop({ index, isNew, cursor }) {
    const found = this.#drawing.draft ? undefined : await pickOr(this.#viewer, this.#page.overlays, cursor);
    this.#moved = undefined;
    const points = found && this.#points.toSpliced(index, isNew ? 0 : 1, ...this.#inFile([found.position]));
    if (points && lineOf(points).length > 1) {
      this.#points = points;
      this.#draw();
    }
    this.#show();
  }

  #let() {
    this.#moved = undefined;
    this.#show();
  }

  #hover(surface) {
    this.#marks.point(this.#points.length === 0 ? surface?.point : undefined);
    if (this.#drawing.draft) this.#show();
  }

  #key(name) {
    const drawing = this.#drawing;
    const acts = {
      Escape: () => (drawing.draft ? this.#cancel() : this.close()),
      Enter: drawing.draft && (() => drawing.finish()),
      ' ': this.#points.length === 0 && (() => drawing.place(drawing.middle)),
      Backspace: drawing.draft && (() => drawing.takeBack()),
      undo: drawing.draft && (() => drawing.takeBack()),
    };
    const act = acts[name];
    if (!act) return false;
    act();
    document.body.classList.toggle('aiming', name === ' ');
    return true;
  }

  // ---- what is seen

  #show() {
    const { draft, shown: made } = this.#drawing;
    const points = made?.points ?? this.#seen(this.#moved ?? this.#points);
    const shown = unitOf(this.#cloud?.crsUnit, undefined);
    const text = points.length > 1 ? valueText({ quantity: 'length', value: lengthOf(lineOf(points)), error: Math.max(this.#step, 0.005) }, shown) : '';
    this.#marks.show({
      points: this.isActive ? points : [], step: this.#step, width: this.#width, text, drawn: Boolean(draft || this.#moved),
      pending: made?.pending ?? [],
    });
    if (!this.isActive) return;
    const how = !this.#isUpright ? words.notUpright : !this.#isAble ? words.degrees : this.#points.length > 0 && !draft ? words.drawn(Boolean(ownShift(this.#viewer.view))) : words.how(touch.matches);
    find('profile-how').textContent = draft && !touch.matches ? `${how} ${words.keys}` : how;
    find('profile-draft').hidden = !draft;
    if (draft) find('profile-done').disabled = draft.lacks > 0 || draft.closing;
  }

  // ---- the server

  /** All of the profile; `isSameLine`: what is measured in it stays, and where one looks. */
  async #draw({ isSameLine = false } = {}) {
    const { plot } = this.#panel;
    this.#panel.show(true, this.#cloud);
    this.#counted = this.#shownAs;
    if (isSameLine && plot.view) {
      const small = wholeQuestion(this.#profile, this.#viewer.view, { width: 64, height: 32 }); // for what it tells, not for its pixels
      await this.#ask(small, words.none, (told, image) => {
        image.close();
        find('profile-said').textContent = words.points(counted(told.points, 'point'));
        this.#panel.say('');
        plot.renew({ length: told.length, heights: told.heights });
      });
      return;
    }
    plot.begin();
    const size = plotSize(plot.size);
    const ask = wholeQuestion(this.#profile, this.#viewer.view, { width: Math.round(size.width * plot.ratio), height: Math.round(size.height * plot.ratio) }, Math.round(1.5 * plot.ratio));
    await this.#ask(ask, words.none, (told, image) => {
      find('profile-said').textContent = words.points(counted(told.points, 'point'));
      this.#panel.say('');
      plot.know({ length: told.length, heights: told.heights });
      plot.show({ image, left: 0, right: told.right, bottom: told.bottom, top: told.top });
    });
  }

  #askPart(edges, view, ratio) {
    const part = partQuestion(this.#profile, this.#viewer.view, edges, { scale: view.scale * ratio, exaggeration: view.exaggeration },
      pointSizeFor(this.#cloud.spacing, view.scale * ratio, Math.round(1.5 * ratio)));
    if (!part) {
      this.#asking?.abort();
      return;
    }
    this.#ask(part.question, words.nothing, (told, image) => {
      this.#panel.say('');
      this.#panel.plot.show({ image, left: part.from, right: part.from + told.right, bottom: told.bottom, top: told.top });
    });
  }

  /** `use(what the server tells, the picture)` hears of it, unless another one is wanted by then. */
  async #ask(question, nothing, use) {
    this.#asking?.abort();
    const asking = new AbortController();
    this.#asking = asking;
    const { plot } = this.#panel;
    if (!plot.view) this.#panel.say(words.asking);
    try {
      const response = await postSoon(this.#viewer.server, this.#cloud.id, 'profile', question, asking.signal);
      const told = toldBy(response);
      const image = await createImageBitmap(await response.blob());
      if (this.#asking === asking) use(told, image);
    } catch (/** @type {any} */ error) {
      if (this.#asking !== asking || asking.signal.aborted) return;
      if (isEmpty(error)) {
        plot.show(undefined);
        this.#panel.say(nothing);
        if (nothing === words.none) find('profile-said').textContent = nothing;
        return;
      }
      this.#panel.say(plot.view ? '' : words.failed);
      this.#page.overlays.toast(words.failed, error.title ? error.message : strings.messages.noAnswer);
    }
  }

  #only() {
    const boxes = boxesAround(lineOf(this.#seen(this.#points)), this.#width, this.#viewer.bounds);
    // What takes away goes on doing so; what keeps something else would keep that beside the corridor.
    const others = (this.#viewer.view.clips ?? []).filter(({ plane, keep }) => plane || keep === 'outside');
    if (boxes && boxes.length + others.length <= mostShapes) this.#viewer.changeStyle({ clips: [...others, ...boxes] });
    else this.#page.overlays.toast(words.noBoxes, words.noBoxesDetail(mostShapes));
  }

  async #save(format) {
    const { overlays } = this.#page;
    const name = `${this.#cloud.id}-profile.${format}`;
    if (format === 'png') {
      downloadBlob(name, await this.#panel.plot.png());
      overlays.toast(words.saved, name, 'done');
      return;
    }
    if (this.#saving) return; // one after the other
    const saving = new AbortController();
    this.#saving = saving;
    const question = pointsQuestion(this.#profile, this.#viewer.view, format);
    const { id } = this.#cloud;
    try {
      const target = await chooseTarget(name, format);
      if (!target) return;
      this.#panel.saving(words.asking);
      await saveAnswer(() => postSoon(this.#viewer.server, id, 'profile', question, saving.signal), target, (done) => this.#panel.saving(words.saving(sizeText(done))), saving.signal);
      overlays.toast(words.saved, target.name, 'done');
    } catch (/** @type {any} */ error) {
      if (saving.signal.aborted) overlays.toast(words.stopped, '', 'done');
      else overlays.toast(words.notSaved, error.title ? error.message : strings.messages.noAnswer);
    } finally {
      this.#saving = undefined;
      this.#panel.saving(undefined);
    }
  }
}
