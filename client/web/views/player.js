// Plays a tour: flies the camera along it (tour.js) and puts each view's style on when it arrives there. Esc, the button, a hand on the
// picture, or its end stops it. Who wants less motion sees one view after the other.

import { element } from '../page/parameter_fields.js';
import { views as words } from '../page/strings/views.js';
import { Tour } from './tour.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const approachMs = 400; // to the first view
const longestStep = 0.25; // seconds; a page that was hidden goes on where it was

export class Player {
  #viewer;
  #calm = matchMedia('(prefers-reduced-motion: reduce)');
  #stops;
  #tour;
  #loop = false;
  #time = 0;
  #last;
  #index = -1;
  #steers = false; // the camera that moves is this one's
  #running; // of the frame that is next
  #text = element('span');
  #bar = element('div', { id: 'touring', hidden: true });

  constructor(viewer) {
    this.#viewer = viewer;
    const stop = element('button', { type: 'button', textContent: words.stop, title: words.stopTip });
    stop.addEventListener('click', () => this.stop());
    this.#text.setAttribute('role', 'status');
    this.#bar.append(this.#text, stop);
    find('hud').before(this.#bar);
    // Whoever moves the camera otherwise - by hand, by a key, back to another view - wants to be there.
    viewer.addEventListener('camera', ({ detail }) => (detail.by === 'hand' || this.#time >= 0) && !this.#steers && this.stop());
    for (const name of ['jump', 'sought']) viewer.addEventListener(name, () => !this.#steers && this.stop());
    // Before presentation mode, which Escape would leave.
    addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !this.isPlaying || document.querySelector('dialog[open]')) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      this.stop();
    }, { capture: true });
  }

  get isPlaying() { return this.#running !== undefined; }

  /** `stops`: two or more { name, camera, style }. */
  play(stops, { seconds, pause, loop }) {
    this.stop();
    this.#stops = loop ? [...stops, stops[0]] : stops;
    this.#tour = new Tour(stops.map(({ camera }) => camera), { seconds, pause, loop });
    this.#loop = loop;
    this.#time = -approachMs / 1000;
    this.#index = -1;
    this.#last = undefined;
    this.#bar.hidden = false;
    document.body.classList.add('touring');
    this.#steer(() => this.#viewer.goTo(stops[0].camera));
    this.#next();
    find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  stop() {
    if (!this.isPlaying) return;
    cancelAnimationFrame(this.#running);
    this.#running = undefined;
    this.#bar.hidden = true;
    this.#text.textContent = '';
    document.body.classList.remove('touring');
  }

  #steer(act) {
    this.#steers = true;
    act();
    this.#steers = false;
  }

  #next() {
    this.#running = requestAnimationFrame((now) => this.#step(now));
  }

  #step(now) {
    this.#time += Math.min(longestStep, (now - (this.#last ?? now)) / 1000);
    this.#last = now;
    if (this.#time > this.#tour.length) {
      if (!this.#loop) {
        this.stop();
        return;
      }
      this.#time -= this.#tour.arrivalAt(this.#tour.count - 1); // it is where it began
    }
    this.#next();
    const { camera, index } = this.#tour.at(Math.max(0, this.#time));
    if (index !== this.#index) this.#arrived(index);
    if (this.#time >= 0 && !this.#calm.matches) this.#steer(() => this.#viewer.changeCamera(camera, 'program'));
  }

  #arrived(index) {
    this.#index = index;
    const { name, camera, style } = this.#stops[index];
    const count = this.#loop ? this.#stops.length - 1 : this.#stops.length;
    this.#text.textContent = words.playing((index % count) + 1, count, name);
    if (this.#calm.matches) this.#steer(() => this.#viewer.goTo(camera));
    this.#viewer.changeStyle(style, 'program');
  }
}
