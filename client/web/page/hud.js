// The line in the corner: whether the picture moves or is sharp, how fast, and, opened, the figures behind it.

import { element } from './parameter_fields.js';
import { amount, counted, strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const windowMs = 1000;
// While the camera moves, pictures that lack something of what is away and pictures that do not may take turns.
const awayLingersMs = 1500;
const words = strings.hud;

const milliseconds = (value) => (Number.isFinite(value) ? `${value < 10 ? value.toFixed(1) : Math.round(value)} ms` : '–');

/** What happened to frames: how many a second, and how long from a request to its picture. Pure but for the clock given. */
export class FrameClock {
  #asked = new Map();
  #drawn = [];
  latency = NaN;

  asked(seq, now) {
    this.#asked.set(seq, now);
    // A server that never answers must not make this grow.
    if (this.#asked.size > 512) this.#asked.delete(this.#asked.keys().next().value);
  }

  /** The first picture of a request tells the latency; refinements of the same one do not. */
  drawn(seq, now) {
    const asked = this.#asked.get(seq);
    if (asked !== undefined) this.latency = now - asked;
    for (const key of this.#asked.keys()) {
      if (key <= seq) this.#asked.delete(key);
    }
    this.#drawn.push(now);
    this.#trim(now);
  }

  #trim(now) {
    while (this.#drawn.length > 0 && now - this.#drawn[0] > windowMs) this.#drawn.shift();
  }

  framesPerSecond(now) {
    this.#trim(now);
    return this.#drawn.length;
  }

  /** For a new connection. */
  reset() {
    this.#asked.clear();
  }
}

export class Hud {
  clock = new FrameClock();
  #frame;
  #stats;
  #method = '';
  #state = 'connecting';
  #damaged = false;
  #away = false; // the last frame says that a part of the server is
  #awayAt = -Infinity; // when one said so last

  constructor() {
    find('hud').addEventListener('toggle', () => this.#render());
    setInterval(() => {
      this.#render();
      this.#showLack();
    }, 500);
  }

  setState(state) {
    this.#state = state;
    this.#render();
  }

  /** A connection has opened: what was asked of another one is not answered by this one. */
  begin() {
    this.clock.reset();
    this.#stats = undefined; // frames count from 1 again
    this.#damaged = this.#away = false;
    this.#awayAt = -Infinity;
    this.#showLack();
  }

  /** A view has been asked for. */
  asked(seq) {
    this.clock.asked(seq, performance.now());
    this.setState('moving');
  }

  frame(frame) {
    this.#frame = frame;
    this.clock.drawn(frame.seq, performance.now());
    this.setState(frame.final ? 'sharp' : frame.still ? 'refining' : 'moving');
    // Frames on the way to the next final still do not know yet whether it lacks something.
    if (frame.final) this.#damaged = frame.damaged;
    this.#away = frame.away;
    if (frame.away) this.#awayAt = performance.now();
    else if (frame.final) this.#awayAt = -Infinity;
    this.#showLack();
  }

  /** The sentences that tell what pictures lack, and for how long. */
  #showLack() {
    const note = find('lack');
    const isAway = this.#away || performance.now() - this.#awayAt < awayLingersMs;
    const said = [this.#damaged ? words.damage : '', isAway ? words.away : ''].filter(Boolean).join(' ');
    note.hidden = said === '';
    if (note.textContent !== said) note.textContent = said;
  }

  /** Figures of one frame: they are shown as long as that one is on screen, and stands still. */
  stats(stats) {
    this.#stats = stats;
    this.#render();
  }

  /** How the view is drawn, in words. */
  setMethod(words) {
    this.#method = words;
  }

  get #statsOfThis() {
    const fits = this.#frame && this.#stats?.frame === this.#frame.frameId && this.#stats.seq === this.#frame.seq;
    return fits && (this.#state === 'sharp' || this.#state === 'refining') ? this.#stats : undefined;
  }

  #render() {
    const hud = find('hud');
    hud.dataset.state = this.#state;
    const said = words.states[this.#state] ?? this.#state;
    // Screen readers hear every change of a status: only real ones, and not each burst of frames.
    if (find('hud-state').textContent !== said) find('hud-state').textContent = said;
    find('hud-brief').textContent = this.#brief();
    if (hud.open) find('hud-figures').replaceChildren(...this.#figures());
  }

  #brief() {
    if (!this.#frame || this.#state === 'lost' || this.#state === 'connecting') return '';
    if (this.#state === 'moving') {
      return `${words.fps(this.clock.framesPerSecond(performance.now()))} · ${milliseconds(this.clock.latency)}`;
    }
    const stats = this.#statsOfThis;
    return stats ? counted(stats.samples, words.sample, words.samples) : `${this.#frame.width} × ${this.#frame.height}`;
  }

  #figures() {
    const frame = this.#frame;
    const stats = this.#statsOfThis;
    const rows = [[words.frameRate, words.fps(this.clock.framesPerSecond(performance.now()))]];
    rows.push([words.latency, milliseconds(this.clock.latency)]);
    if (frame) {
      const { codec, hasFailed, reason } = frame.movingFrames ?? {};
      rows.push([words.movingFrames, hasFailed ? words.videoFailed : [words.codecs[codec], reason].filter(Boolean).join('. ')]);
      rows.push([words.resolution, `${frame.width} × ${frame.height}`]);
      rows.push([words.rendering, milliseconds(frame.renderMicroseconds / 1000)]);
      rows.push([words.encoding, milliseconds(frame.encodeMicroseconds / 1000)]);
      rows.push([words.frameSize, `${amount(Math.round(frame.picture.length / 1000))} kB`]);
    }
    if (this.#method) rows.push([words.method, this.#method]);
    if (stats) {
      rows.push([words.samplesDrawn, amount(stats.samples)]);
      rows.push([words.pointsShown, amount(stats.points)]);
      if (stats.detail > 0) rows.push([words.detail, `${stats.detail.toPrecision(2)} px`]);
      if (stats.jpegQuality > 0) rows.push([words.quality, stats.jpegQuality]);
      if (stats.bandwidth > 0) rows.push([words.network, `${amount(Math.round(stats.bandwidth / 1000))} kB/s`]);
      for (const stage of (stats.stages ?? []).slice(0, 12)) rows.push([`· ${stage.name}`, milliseconds(stage.milliseconds)]);
    }
    return rows.flatMap(([term, value]) => [element('dt', { textContent: term }), element('dd', { textContent: value })]);
  }
}
