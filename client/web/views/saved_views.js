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
import { longestName, mostViews, pauseRange, secondsRange, stopsOf, toursWith, usualTour } from './saved.js';

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

  #save() {
    const view = this.#now;
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
    if (free !== name) this.#inTours(name, free);
  }

  #remove(id) {
    const { name } = this.#views.find(id);
    this.#views.remove(id);
    this.#inTours(name, undefined);
  }

  #inTours(name, next) {
    if (this.#tours.list.some(({ views }) => views?.includes(name))) this.#tours.replace(toursWith(this.#tours.list, name, next));
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
    // Pictures that are there stay until there are others.
    const pictures = new Map([...find('saved-list').querySelectorAll('.thumbnail')].map((node) => [node.dataset.view, node]));
    find('saved-list').replaceChildren(...list.map((saved, i) => this.#row(saved, i, pictures.get(saved.view))));
    if (focused && !this.#focus(focused)) find('save-view').focus();
    this.#showTour();
    const shown = list.map(({ view }) => view).join('\n');
    if (shown !== this.#pictured) this.#page.galleries.renew();
    this.#pictured = shown;
  }

  #focus(key, selects = false) {
    const found = find('saved-list').querySelector(`[data-key="${CSS.escape(key)}"]:not(:disabled)`);
    found?.focus();
    if (selects) found?.select();
    return Boolean(found);
  }

  #button(key, text, label, act, disabled = false) {
    const button = element('button', { type: 'button', textContent: text, title: label, disabled, className: 'small' });
    button.setAttribute('aria-label', label);
    button.dataset.key = key;
    button.addEventListener('click', act);
    return button;
  }

  #row(saved, index, picture) {
    const { id, name, view } = saved;
    const thumbnail = picture ?? element('span', { className: 'thumbnail' });
    thumbnail.dataset.view = view;
    const go = this.#button(`go-${id}`, '', words.go(name), () => this.#go(saved));
    go.className = 'go';
    go.append(thumbnail);
    const field = element('input', { type: 'text', value: name, maxLength: longestName, autocomplete: 'off', ariaLabel: words.name });
    field.dataset.key = `name-${id}`;
    field.addEventListener('change', () => this.#rename(id, field.value));
    return element('li', {}, go, field, element('div', { className: 'row' },
      this.#button(`earlier-${id}`, words.earlier, words.earlierNamed(name), () => this.#views.move(id, -1), index === 0),
      this.#button(`later-${id}`, words.later, words.laterNamed(name), () => this.#views.move(id, 1), index === this.#views.list.length - 1),
      this.#button(`update-${id}`, words.update, words.updateNamed(name), () => this.#views.change(id, { view: this.#now })),
      this.#button(`remove-${id}`, words.remove, words.removeNamed(name), () => this.#remove(id))));
  }

  /** What the gallery is to have pictures of: [{ changes, place }]. */
  #pictures() {
    return this.#views.list.flatMap((saved) => {
      const meant = this.#viewer.cloud && this.#meant(saved);
      const place = find('saved-list').querySelector(`.thumbnail[data-view="${CSS.escape(saved.view)}"]`);
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
