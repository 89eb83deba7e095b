// Saved views, in the gallery of views below those that the server suggests: kept, named, reordered, gone to, and played one after the
// other as a tour (player.js). Kept with the project (measure/keeping.js).

import { icon } from '../page/icons.js';
import { element } from '../page/parameter_fields.js';
import { fillStrings } from '../page/strings.js';
import { views as words } from '../page/strings/views.js';
import { cameraOf, wireOf } from '../view/camera_words.js';
import { restyled, usualStyle } from '../view/usual.js';
import { parseHash } from '../view/view_hash.js';
import { Player } from './player.js';
import { longestName, longestView, mostViews, pauseRange, secondsRange, stopsOf, usualTour } from './saved.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

const markup = `
<section id="saved-views" aria-labelledby="saved-title">
  <div class="row heading">
    <h2 id="saved-title" data-text="title"></h2>
    <button type="button" id="saved-undo" data-label="undo" data-tip="undoTip" disabled></button>
  </div>
  <div class="buttons">
    <button type="button" id="save-view" data-text="save" data-tip="saveTip"></button>
    <button type="button" id="play-tour" data-text="play" data-tip="playTip"></button>
  </div>
  <p id="saved-none" class="note" data-text="none"></p>
  <ol id="saved-list" data-label="list"></ol>
  <div id="tour-fields">
    <label id="tour-choice" hidden><span data-text="tours"></span><select id="tour-name"></select></label>
    <label><span data-text="seconds"></span><input type="number" id="tour-seconds" step="any"></label>
    <label><span data-text="pause"></span><input type="number" id="tour-pause" step="any"></label>
    <label class="check"><input type="checkbox" id="tour-loop"><span data-text="loop"></span></label>
  </div>
  <div class="buttons">
    <button type="button" id="views-save-project" data-text="saveProject"></button>
    <button type="button" id="views-open-project" data-text="openProject"></button>
  </div>
</section>
`;

export class SavedViews {
  #viewer;
  #page;
  #views;
  #tours;
  #chosen = ''; // the tour's name
  #player;
  #rows = new Map(); // id → { node, thumbnail, show(saved, index, count) }
  #pictured = ''; // the views that the gallery has been asked for pictures of

  /** `page`: { keeping (the project), hash() (the view as an address says it), overlays (messages), galleries (whose pictures these are among) } */
  constructor(viewer, page) {
    this.#viewer = viewer;
    this.#page = page;
    this.#views = page.keeping.views;
    this.#tours = page.keeping.tours;
    this.#player = new Player(viewer);
    const template = element('template', { innerHTML: markup });
    fillStrings(template.content, words);
    find('views-gallery').append(template.content);
    find('saved-undo').append(icon('undo'));
    this.#connect();
    for (const list of [this.#views, this.#tours]) list.addEventListener('change', () => this.#show());
    page.galleries.also(() => this.#pictures());
    viewer.addEventListener('begin', () => this.#player.stop());
    this.#show();
  }

  get isPlaying() { return this.#player.isPlaying; }

  #connect() {
    const on = (id, act, name = 'click') => find(id).addEventListener(name, () => act(find(id)));
    on('save-view', () => this.#save());
    on('play-tour', () => this.play());
    on('saved-undo', () => this.#views.undo());
    on('views-save-project', () => this.#page.keeping.save());
    on('views-open-project', () => this.#page.keeping.choose());
    on('tour-name', ({ value }) => {
      this.#chosen = value;
      this.#showTour();
    }, 'change');
    const number = (id, name, { least, most }) => {
      Object.assign(find(id), { min: String(least), max: String(most) });
      on(id, ({ valueAsNumber: value }) => {
        if (value >= least && value <= most) this.#changeTour({ [name]: value });
        else this.#showTour();
      }, 'change');
    };
    number('tour-seconds', 'seconds', secondsRange);
    number('tour-pause', 'pause', pauseRange);
    on('tour-loop', ({ checked }) => this.#changeTour({ loop: checked }), 'change');
  }

  // ---- the list

  get #now() { return this.#page.hash().replace(/^#/, ''); }

  /** The view as it is now; '' where there is none, or none that a project could keep, which is said. */
  #keepable() {
    const view = this.#now;
    if (view.length <= longestView) return view;
    this.#page.overlays.toast(words.tooLong, words.tooLongDetail);
    return '';
  }

  #save() {
    const view = this.#keepable();
    if (!view) return;
    const id = this.#views.add({ name: this.#views.nameFor(words.first), view });
    if (id === undefined) this.#page.overlays.toast(words.tooMany, words.tooManyDetail(mostViews));
    else this.#focus(`name-${id}`, true);
  }

  /** No two views have one name: tours know them by it. */
  #rename(id, wanted) {
    const { name } = this.#views.find(id);
    const isFree = (text) => !this.#views.list.some((one) => one.id !== id && one.name === text);
    const text = wanted.trim().slice(0, longestName) || name;
    const free = isFree(text) ? text : this.#views.nameFor(text.slice(0, longestName - 8));
    this.#views.change(id, { name: free });
  }

  #update(id) {
    const view = this.#keepable();
    if (view) this.#views.change(id, { view });
  }

  /** @returns {{ camera: any, style: any } | undefined} what a saved view shows of this cloud */
  #meant({ view }) {
    const { cloud, bounds } = this.#viewer;
    const link = parseHash(`#${view}`);
    const camera = link?.camera && cameraOf(link.camera, wireOf(this.#viewer.usualCamera(), bounds), link.upAxis);
    return camera && { camera, style: restyled(usualStyle(cloud), link.style) };
  }

  #go(saved) {
    if (!this.#viewer.cloud) return;
    const meant = this.#meant(saved);
    if (!meant) {
      this.#page.overlays.toast(words.unreadable(saved.name), words.unreadableDetail);
      return;
    }
    this.#viewer.goTo(meant.camera);
    this.#viewer.changeStyle(meant.style, 'program');
  }

  #show() {
    const { list } = this.#views;
    find('saved-none').hidden = list.length > 0;
    find('saved-list').hidden = list.length === 0;
    find('saved-undo').disabled = !this.#views.canUndo;
    /** @type {any} */
    const active = document.activeElement;
    const focused = active?.closest?.('#saved-list') && active.dataset.key;
    // A row stays what it is: whoever presses one of its buttons out of a field that has just changed would press nothing.
    const before = this.#rows;
    this.#rows = new Map(list.map(({ id }) => [id, before.get(id) ?? this.#row(id)]));
    list.forEach((saved, i) => this.#rows.get(saved.id).show(saved, i, list.length));
    const rows = [...this.#rows.values()].map(({ node }) => node);
    const shown = [...find('saved-list').children];
    if (rows.length !== shown.length || rows.some((row, i) => row !== shown[i])) find('saved-list').replaceChildren(...rows);
    if (focused && document.activeElement !== active && !this.#focus(focused)) find('save-view').focus();
    this.#showTour();
    const pictured = list.map(({ view }) => view).join('\n');
    if (pictured !== this.#pictured) this.#page.galleries.renew();
    this.#pictured = pictured;
  }

  #focus(key, selects = false) {
    const found = find('saved-list').querySelector(`[data-key="${CSS.escape(key)}"]:not(:disabled)`);
    found?.focus();
    if (selects) found?.select();
    return Boolean(found);
  }

  #button(key, text, act) {
    const button = element('button', { type: 'button', textContent: text, className: 'small' });
    button.dataset.key = key;
    button.addEventListener('click', act);
    return button;
  }

  #row(id) {
    const thumbnail = element('span', { className: 'thumbnail' });
    const go = this.#button(`go-${id}`, '', () => this.#go(this.#views.find(id)));
    go.className = 'go';
    go.append(thumbnail);
    const field = element('input', { type: 'text', maxLength: longestName, autocomplete: 'off', ariaLabel: words.name });
    field.dataset.key = `name-${id}`;
    field.addEventListener('change', () => this.#rename(id, field.value));
    const earlier = this.#button(`earlier-${id}`, words.earlier, () => this.#views.move(id, -1));
    const later = this.#button(`later-${id}`, words.later, () => this.#views.move(id, 1));
    const update = this.#button(`update-${id}`, words.update, () => this.#update(id));
    const remove = this.#button(`remove-${id}`, words.remove, () => this.#views.remove(id));
    const node = element('li', {}, go, field, element('div', { className: 'row' }, earlier, later, update, remove));
    const show = ({ name, view }, index, count) => {
      if (field.value !== name) field.value = name;
      for (const [button, label] of [[go, words.go(name)], [earlier, words.earlierNamed(name)], [later, words.laterNamed(name)], [update, words.updateNamed(name)], [remove, words.removeNamed(name)]]) {
        button.title = label;
        button.setAttribute('aria-label', label);
      }
      earlier.disabled = index === 0;
      later.disabled = index === count - 1;
      if (thumbnail.dataset.view !== view) thumbnail.replaceChildren();
      thumbnail.dataset.view = view;
    };
    return { node, thumbnail, show };
  }

  /** What the gallery is to have pictures of: [{ changes, place }]. */
  #pictures() {
    return this.#views.list.flatMap((saved) => {
      const meant = this.#viewer.cloud && this.#meant(saved);
      const place = this.#rows.get(saved.id)?.thumbnail;
      return meant && place ? [{ changes: { ...meant.style, camera: wireOf(meant.camera, this.#viewer.bounds) }, place }] : [];
    });
  }

  // ---- the tour

  get #tour() {
    return this.#tours.list.find(({ name }) => name === this.#chosen) ?? this.#tours.list[0] ?? usualTour;
  }

  #changeTour(changes) {
    const tour = this.#tour;
    if (tour.id === undefined) this.#tours.add({ ...tour, ...changes });
    else this.#tours.change(tour.id, changes);
  }

  #showTour() {
    const { list } = this.#tours;
    const tour = this.#tour;
    find('tour-choice').hidden = list.length < 2;
    find('tour-name').replaceChildren(...list.map(({ name }) => element('option', { value: name, textContent: name, selected: name === tour.name })));
    find('tour-seconds').value = String(tour.seconds);
    find('tour-pause').value = String(tour.pause);
    find('tour-loop').checked = tour.loop;
    find('tour-fields').hidden = this.#views.list.length < 2;
    find('play-tour').disabled = stopsOf(tour, this.#views.list).length < 2;
  }

  stop() { this.#player.stop(); }

  /** Plays it; ends it, where it is being played. */
  play() {
    if (this.isPlaying) {
      this.#player.stop();
      return;
    }
    const { overlays } = this.#page;
    const tour = this.#tour;
    const stops = stopsOf(tour, this.#views.list).flatMap((saved) => {
      const meant = this.#viewer.cloud && this.#meant(saved);
      return meant ? [{ name: saved.name, ...meant }] : [];
    });
    if (stops.length < 2) overlays.toast(words.tooFew, words.tooFewDetail);
    else if (stops.some(({ camera }) => camera.upAxis !== stops[0].camera.upAxis)) overlays.toast(words.otherAxis, words.otherAxisDetail);
    else {
      find('views-gallery').hidePopover();
      this.#player.play(stops, tour);
    }
  }
}
