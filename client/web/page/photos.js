// The photos that the scan brought along: a button with their number in the panel, another one for those of the scan position
// that somebody has just gone to, and a viewer over the page. They are shown flat, as they were taken; a panorama, too.
//
// A photo is fetched, with the token that <img> could not send, and shown by an address of this page's own (blob:).

import { problemOf, ServerProblem } from '../connection/server.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = strings.photos;
const largestOfFit = 2; // small ones are shown this much larger than they are
const forgetMs = 60_000; // a tab that was opened with it has it by then
const keyStep = 80; // px
const busyMs = 1200; // a server that has too much to do says so; what was left a moment ago may be all that it is
const mostTries = 3;

/** "1 photo", "12 photos". Pure. */
export const photosText = words.many;

/** 5300000 → "5.3 MB". Pure. */
export function sizeText(bytes) {
  for (const { size, unit } of [{ size: 1e6, unit: 'MB' }, { size: 1e3, unit: 'kB' }]) {
    if (bytes >= size) return `${Number((bytes / size).toPrecision(bytes >= 100 * size ? 3 : 2)).toLocaleString('en')} ${unit}`;
  }
  return `${bytes} bytes`;
}

const kindOf = ({ projection }) => words.kinds[projection] ?? words.kinds.pinhole;

/** "Panorama, 8,192 × 4,096, 5.3 MB, taken at Tower". Pure. */
export function factsOf(photo) {
  const kind = kindOf(photo);
  const parts = [kind.charAt(0).toUpperCase() + kind.slice(1)];
  if (photo.width && photo.height) parts.push(`${photo.width.toLocaleString('en')} × ${photo.height.toLocaleString('en')}`);
  parts.push(sizeText(photo.bytes));
  if (photo.station) parts.push(words.takenAt(photo.station.name));
  return parts.join(', ');
}

/** What who cannot see it is told. Pure. */
export function altOf(photo) {
  const named = words.alt(kindOf(photo), photo.name);
  return photo.station ? `${named}, ${words.takenAt(photo.station.name)}` : named;
}

/** Screen pixels for each of the photo's, so that all of it is to be seen. Pure. */
export function fittedScale(photo, room) {
  const scale = Math.min(room.width / photo.width, room.height / photo.height, largestOfFit);
  return scale > 0 && Number.isFinite(scale) ? scale : 1;
}

/** How many times as large as fitted it may become: twice the photo's own size, at least four times. Pure. */
export const mostZoom = (fitted) => Math.max(4, 2 / fitted);

export class Photos {
  #cloud; // that they are of; undefined where it has none
  #list; // of that cloud, once somebody has asked for them
  #here = []; // numbers of those of the scan position that was chosen last
  #place; // its view, for photos of which nobody knows where they look
  #index = 0;
  #zoom = 1; // 1 = fitted
  #loading; // AbortController of what is on its way
  #url = '';
  #server;
  #go;
  #dialog = find('photos');
  #stage = find('photo-stage');
  #image = find('photo');

  /** `go(camera)` gets a camera as the protocol has it; `size()` is the picture's, { width, height }. */
  constructor(server, go, size) {
    this.#server = server;
    this.#go = go;
    find('show-photos').addEventListener('click', () => this.#open(0, size()));
    find('station-photos').addEventListener('click', () => this.#open(this.#here[0], size()));
    find('photo-close').addEventListener('click', () => this.#dialog.close());
    find('photo-previous').addEventListener('click', () => this.#turnTo(this.#index - 1));
    find('photo-next').addEventListener('click', () => this.#turnTo(this.#index + 1));
    find('photo-go').addEventListener('click', () => this.#lookFromHere());
    find('photo-retry').addEventListener('click', () => this.#open(this.#index, size()));
    find('photo-smaller').addEventListener('click', () => this.#zoomTo(this.#zoom / 1.5));
    find('photo-larger').addEventListener('click', () => this.#zoomTo(this.#zoom * 1.5));
    this.#dialog.addEventListener('close', () => {
      if (!this.#dialog.open) this.#forget(); // it is told a little later, when it may be open again
    });
    this.#dialog.addEventListener('click', ({ target }) => {
      if (target === this.#dialog || (target === this.#stage && this.#zoom === 1)) this.#dialog.close(); // beside it
    });
    this.#stage.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    this.#image.addEventListener('dblclick', (event) => this.#zoomTo(this.#zoom > 1 ? 1 : Math.max(2, 1 / this.#fitted()), event));
    this.#dragByMouse();
    new ResizeObserver(() => this.#resize()).observe(this.#stage);
    // Before anybody else: while it is open, keys are the viewer's.
    addEventListener('keydown', (event) => {
      if (!this.#dialog.open) return;
      event.stopPropagation();
      this.#key(event);
    }, { capture: true });
  }

  /** The photos of this cloud, `undefined`: of none. */
  show(cloud) {
    const count = cloud?.photos > 0 ? cloud.photos : 0;
    const known = this.#cloud;
    if (known && cloud && known.id === cloud.id && known.revision === cloud.revision && known.photos === count) return;
    this.#cloud = count > 0 ? { id: cloud.id, revision: cloud.revision, photos: count } : undefined;
    this.#list = undefined;
    this.#dialog.close();
    find('show-photos').hidden = count === 0;
    find('show-photos').textContent = words.button(count);
    this.at(undefined);
  }

  /** Offers those that were taken at this scan position, as the API has it; `undefined`: at none. */
  at(station) {
    this.#here = this.#cloud ? (station?.photos ?? []) : [];
    this.#place = station?.view;
    find('station-photos').hidden = this.#here.length === 0;
    if (this.#here.length > 0) find('station-photos').textContent = words.takenHere(this.#here.length, station.name);
  }

  async #open(index, size) {
    if (!this.#dialog.open) this.#dialog.showModal();
    this.#say(words.loading);
    this.#index = index;
    if (!this.#list) this.#blank();
    const cloud = this.#cloud;
    try {
      const list = this.#list ?? await this.#server.photos(cloud.id, size);
      if (this.#cloud !== cloud) return; // another one's since
      this.#list = list;
    } catch (error) {
      if (this.#cloud === cloud && this.#dialog.open) this.#fail(error);
      return;
    }
    if (this.#dialog.open) this.#turnTo(index);
  }

  /** Nothing of the photo before stands over what is being waited for. */
  #blank() {
    for (const id of ['photo-title', 'photo-facts', 'photo-count']) find(id).textContent = '';
    for (const id of ['photo-previous', 'photo-next', 'photo-count', 'photo-go']) find(id).hidden = true;
  }

  #turnTo(index) {
    if (!this.#list) return; // it is on its way
    const count = this.#list.length;
    if (count === 0) {
      this.#blank();
      this.#say(words.gone);
      return;
    }
    this.#index = (index + count) % count;
    const photo = this.#list[this.#index];
    find('photo-title').textContent = photo.name;
    find('photo-facts').textContent = factsOf(photo);
    find('photo-count').textContent = words.count(this.#index + 1, count);
    for (const id of ['photo-previous', 'photo-next', 'photo-count']) find(id).hidden = count === 1;
    find('photo-go').hidden = !this.#viewOf(photo);
    this.#load(photo);
  }

  async #load(photo) {
    this.#forget();
    const mine = (this.#loading = new AbortController());
    this.#say(words.loadingSize(sizeText(photo.bytes)));
    try {
      const response = await this.#fetch(photo.href, mine.signal);
      const url = URL.createObjectURL(await response.blob());
      if (mine.signal.aborted) return URL.revokeObjectURL(url);
      this.#url = url;
      this.#image.src = url;
      await this.#image.decode().catch(() => {
        throw new ServerProblem({ title: words.unreadable, detail: words.unreadableDetail });
      });
      if (mine.signal.aborted) return undefined;
      this.#image.alt = altOf(photo);
      this.#image.hidden = false;
      find('photo-open').href = url;
      this.#ready(true);
      this.#say('');
      this.#zoom = 1;
      this.#resize();
    } catch (error) {
      if (!mine.signal.aborted) this.#fail(error);
    }
    return undefined;
  }

  async #fetch(href, signal) {
    for (let tries = 1; ; ++tries) {
      const response = await this.#server.fetch(href, { signal });
      if (response.ok) return response;
      if (tries === mostTries || ![429, 503].includes(response.status)) throw await problemOf(response);
      await new Promise((done) => { setTimeout(done, busyMs); });
    }
  }

  /** What is shown or on its way is not any more. */
  #forget() {
    this.#loading?.abort();
    this.#loading = undefined;
    this.#ready(false);
    this.#image.hidden = true;
    this.#image.removeAttribute('src');
    find('photo-open').removeAttribute('href');
    const url = this.#url;
    this.#url = '';
    if (url) setTimeout(() => URL.revokeObjectURL(url), forgetMs);
  }

  #ready(isThere) {
    for (const id of ['photo-open', 'photo-smaller', 'photo-larger']) find(id).hidden = !isThere;
  }

  #say(text, failed = false) {
    find('photo-state').hidden = text === '';
    find('photo-state-text').textContent = text;
    find('photo-retry').hidden = !failed;
  }

  #fail(error) {
    const known = error instanceof ServerProblem;
    this.#say(known ? [...new Set([error.title, error.message])].join('. ') : words.noAnswer, true);
  }

  /** A photo without a pose was still taken somewhere. */
  #viewOf(photo) {
    return photo.view ?? (this.#here.includes(photo.index) ? this.#place : undefined);
  }

  #lookFromHere() {
    const photo = this.#list?.[this.#index];
    if (!photo) return;
    const view = this.#viewOf(photo);
    this.#dialog.close();
    if (view) this.#go(view.camera);
  }

  // ---- how large it is

  #natural() {
    return { width: this.#image.naturalWidth, height: this.#image.naturalHeight };
  }

  #fitted() {
    const { clientWidth: width, clientHeight: height } = this.#stage;
    return fittedScale(this.#natural(), { width, height });
  }

  #resize() {
    if (this.#image.hidden) return;
    const scale = this.#fitted() * this.#zoom;
    const { width, height } = this.#natural();
    this.#image.width = Math.max(1, Math.floor(width * scale));
    this.#image.height = Math.max(1, Math.floor(height * scale));
    this.#stage.classList.toggle('zoomed', this.#zoom > 1);
    find('photo-smaller').disabled = this.#zoom === 1;
    find('photo-larger').disabled = this.#zoom >= mostZoom(this.#fitted());
  }

  /** What is under the cursor stays there; without one, what is in the middle. */
  #zoomTo(wanted, cursor) {
    if (this.#image.hidden) return;
    const zoom = Math.min(mostZoom(this.#fitted()), Math.max(1, wanted));
    const stage = this.#stage.getBoundingClientRect(), before = this.#image.getBoundingClientRect();
    const x = cursor?.clientX ?? stage.left + stage.width / 2, y = cursor?.clientY ?? stage.top + stage.height / 2;
    const across = (x - before.left) / before.width, down = (y - before.top) / before.height;
    this.#zoom = zoom < 1.001 ? 1 : zoom;
    this.#resize();
    const after = this.#image.getBoundingClientRect();
    this.#stage.scrollBy({ left: after.left + across * after.width - x, top: after.top + down * after.height - y, behavior: 'instant' });
  }

  #wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * [1, 16, 400][event.deltaMode];
    this.#zoomTo(this.#zoom * Math.exp(-0.0015 * pixels), event);
  }

  /** A finger scrolls by itself. */
  #dragByMouse() {
    let from;
    this.#image.addEventListener('pointerdown', (event) => {
      if (event.pointerType !== 'mouse' || event.button !== 0) return;
      event.preventDefault();
      from = { x: event.clientX, y: event.clientY };
      this.#image.setPointerCapture(event.pointerId);
      this.#stage.classList.add('grabbed');
    });
    this.#image.addEventListener('pointermove', (event) => {
      if (!from) return;
      this.#stage.scrollBy({ left: from.x - event.clientX, top: from.y - event.clientY, behavior: 'instant' });
      from = { x: event.clientX, y: event.clientY };
    });
    this.#image.addEventListener('lostpointercapture', () => {
      from = undefined;
      this.#stage.classList.remove('grabbed');
    });
  }

  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (step) {
      event.preventDefault();
      if (this.#zoom > 1) this.#stage.scrollBy({ left: step[0] * keyStep, top: step[1] * keyStep, behavior: 'instant' });
      else if (step[0] !== 0) this.#turnTo(this.#index + step[0]);
    } else if (event.key === '+' || event.key === '=') {
      this.#zoomTo(this.#zoom * 1.5);
    } else if (event.key === '-') {
      this.#zoomTo(this.#zoom / 1.5);
    } else if (event.key === '0') {
      this.#zoomTo(1);
    }
  }
}
