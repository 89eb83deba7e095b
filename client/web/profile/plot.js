// The panel's canvas: a profile's picture with its axes, which a hand moves and zooms as it does a map, and in which it measures between two places. What
// is drawn there is asked of the server anew for each view, so that it is sharp at any scale; until that is there, the last picture is stretched.

import { margin, paint, plotSize } from './paint.js';
import { edgesOf, exaggerated, fitted, fromPixel, nearestDrawn, panned, usualExaggeration, zoomed } from './plot_view.js';

const snapPx = 9; // a cursor takes the drawn point that is as near
const clickPx = 5;
const askAfterMs = 160;
const stepPx = 12; // of the arrow keys

export class Plot {
  #canvas;
  #does;
  #context;
  #view;
  #picture;
  #pixels; // of the picture, for what is drawn where
  #profile; // { length, heights } of all of it
  #places = []; // that are measured between
  #cross;
  #cursor; // CSS pixels in the plot
  #downs = new Map(); // pointers that are down
  #timer;
  #painting = false;

  /**
   * `does`: wants(edges, view, device pixels for a CSS pixel) - a picture of that part is wanted; moved(view); hover(place or undefined); measured(places); text(places), what
   * stands at them; words(), the axes'
   */
  constructor(canvas, does) {
    this.#canvas = canvas;
    this.#does = does;
    this.#context = canvas.getContext('2d');
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => this.#up(event));
    canvas.addEventListener('pointerleave', () => this.#downs.size === 0 && this.#point(undefined));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      if (this.#view) this.#change(zoomed(this.#view, this.#plot, this.#at(event), Math.exp(-0.0016 * event.deltaY), this.#profile.length));
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('blur', () => this.#point(undefined));
    new ResizeObserver(() => this.#resized()).observe(canvas);
    matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => this.paint());
    new MutationObserver(() => this.paint()).observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] }); // themes.js
  }

  get view() { return this.#view; }
  get size() { return { width: this.#canvas.clientWidth, height: this.#canvas.clientHeight }; }
  get ratio() { return Math.min(3, devicePixelRatio || 1); }
  get places() { return this.#places; }
  get #plot() { return plotSize(this.size); }

  /** Another line: nothing is shown until its profile is known. */
  begin() {
    this.#view = this.#picture = this.#pixels = this.#profile = this.#cross = undefined;
    this.#places = [];
    clearTimeout(this.#timer);
    this.#does.measured([]);
    this.#does.hover(undefined);
    this.paint();
  }

  /** `profile`: { length, heights } of all of it, which is shown then. */
  know(profile) {
    this.#profile = profile;
    this.fit();
  }

  /** The same line, of which other points are shown now: one goes on looking where one does. */
  renew(profile) {
    this.#profile = profile;
    this.ask();
  }

  fit() {
    if (!this.#profile) return;
    const { length, heights } = this.#profile;
    this.#change(fitted(length, heights, this.#plot, usualExaggeration(length, heights, this.#plot)));
  }

  /** A picture of a part of it: { image, left, right, bottom, top }; undefined where nothing is. */
  show(picture) {
    this.#picture = undefined;
    if (picture) {
      const { image } = picture;
      const canvas = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      this.#pixels = context.getImageData(0, 0, image.width, image.height);
      image.close(); // a bitmap is memory of the browser's, not of this page's
      this.#picture = { ...picture, image: canvas };
    } else this.#pixels = undefined;
    this.paint();
  }

  set exaggeration(times) {
    if (this.#view) this.#change(exaggerated(this.#view, this.#plot, times));
  }

  zoom(factor) {
    if (this.#view) this.#change(zoomed(this.#view, this.#plot, this.#cursor ?? { x: this.#plot.width / 2, y: this.#plot.height / 2 }, factor, this.#profile.length));
  }

  clear() {
    this.#places = [];
    this.#does.measured(this.#places);
    this.paint();
  }

  #change(view) {
    if (!view || !this.#profile) return;
    this.#view = view;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.ask(), askAfterMs);
    this.#does.moved(view);
    this.paint();
  }

  /** For a picture of what is seen now. */
  ask() {
    clearTimeout(this.#timer);
    if (this.#view) this.#does.wants(edgesOf(this.#view, this.#plot), this.#view, this.ratio);
  }

  #resized() {
    const { width, height } = this.size;
    if (width === 0 || height === 0) return;
    if (this.#view) this.#change({ ...this.#view });
    else this.paint();
  }

  // ---- painting

  paint() {
    if (this.#painting) return;
    this.#painting = true;
    requestAnimationFrame(() => {
      this.#painting = false;
      const { width, height } = this.size;
      if (width === 0 || height === 0) return;
      const [wide, high] = [Math.round(width * this.ratio), Math.round(height * this.ratio)];
      if (this.#canvas.width !== wide || this.#canvas.height !== high) Object.assign(this.#canvas, { width: wide, height: high });
      paint(this.#context, this.#what);
    });
  }

  get #what() {
    const style = getComputedStyle(this.#canvas);
    return {
      view: this.#view, size: this.size, ratio: this.ratio, picture: this.#picture, words: this.#does.words(), cross: this.#cross,
      colours: { ground: style.backgroundColor, ink: style.color, mark: '#ffd447', halo: 'rgb(0 0 0 / 70%)' },
      measure: { places: this.#places, text: this.#places.length === 2 ? this.#does.text(this.#places) : '' },
    };
  }

  /** As a picture with axes, twice as fine as what a plain display shows: a Blob. */
  async png() {
    const canvas = document.createElement('canvas');
    const ratio = Math.max(2, this.ratio);
    const { width, height } = this.size;
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    paint(canvas.getContext('2d'), { ...this.#what, ratio, cross: undefined });
    return new Promise((done) => { canvas.toBlob(done, 'image/png'); });
  }

  // ---- the hand

  #at(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { x: event.clientX - box.left - margin.left, y: event.clientY - box.top - margin.top };
  }

  #isInside({ x, y }) {
    const { width, height } = this.#plot;
    return x >= 0 && y >= 0 && x <= width && y <= height;
  }

  /** What is drawn near there, else the very place. */
  #placeAt(cursor) {
    const place = fromPixel(this.#view, this.#plot, cursor);
    if (!this.#pixels) return { ...place, isDrawn: false };
    const { image, left, right, bottom, top } = this.#picture;
    const [across, up] = [image.width / (right - left), image.height / (top - bottom)];
    const px = across / this.#view.scale; // of the picture for one of the plot
    const found = nearestDrawn(this.#pixels, (place.station - left) * across - 0.5, (top - place.height) * up - 0.5, snapPx * px);
    return found ? { station: left + (found.x + 0.5) / across, height: top - (found.y + 0.5) / up, isDrawn: true } : { ...place, isDrawn: false };
  }

  #point(cursor) {
    this.#cursor = cursor;
    const place = cursor && this.#view && this.#isInside(cursor) ? this.#placeAt(cursor) : undefined;
    this.#cross = place;
    this.#does.hover(place);
    this.paint();
  }

  #take(place) {
    this.#places = this.#places.length === 2 ? [place] : [...this.#places, place];
    this.#does.measured(this.#places);
    this.paint();
  }

  #down(event) {
    if (!this.#view || event.button !== 0) return;
    this.#canvas.setPointerCapture(event.pointerId);
    this.#downs.set(event.pointerId, { start: this.#at(event), at: this.#at(event), moved: this.#downs.size > 0 });
    if (this.#downs.size > 1) for (const down of this.#downs.values()) down.moved = true;
  }

  #move(event) {
    const cursor = this.#at(event);
    const down = this.#downs.get(event.pointerId);
    if (!this.#view) return;
    if (!down) {
      if (event.pointerType !== 'touch') this.#point(cursor);
      return;
    }
    down.moved ||= Math.hypot(cursor.x - down.start.x, cursor.y - down.start.y) > clickPx;
    if (!down.moved) return;
    const other = [...this.#downs].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const apart = ({ at }) => Math.max(20, Math.hypot(at.x - other.at.x, at.y - other.at.y));
      this.#change(zoomed(this.#view, this.#plot, other.at, apart({ at: cursor }) / apart(down), this.#profile.length));
    } else this.#change(panned(this.#view, { x: cursor.x - down.at.x, y: cursor.y - down.at.y }));
    down.at = cursor;
  }

  #up(event) {
    const down = this.#downs.get(event.pointerId);
    this.#downs.delete(event.pointerId);
    if (!down || down.moved || event.type === 'pointercancel' || !this.#isInside(down.at)) return;
    this.#point(down.at);
    if (this.#cross) this.#take(this.#cross);
  }

  #key(event) {
    if (!this.#view || event.ctrlKey || event.metaKey || event.altKey) return;
    const { width, height } = this.#plot;
    const step = event.shiftKey ? 1 : stepPx;
    const go = (x, y) => () => {
      const from = this.#cursor && this.#isInside(this.#cursor) ? this.#cursor : { x: width / 2, y: height / 2 };
      const to = { x: from.x + x * step, y: from.y + y * step };
      const inside = { x: Math.min(width, Math.max(0, to.x)), y: Math.min(height, Math.max(0, to.y)) };
      if (inside.x !== to.x || inside.y !== to.y) this.#change(panned(this.#view, { x: inside.x - to.x, y: inside.y - to.y }));
      this.#point(inside);
    };
    const acts = {
      ArrowLeft: go(-1, 0), ArrowRight: go(1, 0), ArrowUp: go(0, -1), ArrowDown: go(0, 1), '+': () => this.zoom(1.4), '-': () => this.zoom(1 / 1.4),
      Home: () => this.fit(), Enter: () => this.#cross && this.#take(this.#cross), ' ': () => this.#cross && this.#take(this.#cross),
      Escape: this.#places.length > 0 && (() => this.clear()),
    };
    const act = acts[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
  }
}
