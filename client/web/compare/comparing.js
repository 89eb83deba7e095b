// Comparing: a second picture over the right part of the first, by another method, in other colours, of another cloud, from the same camera, and
// a divider between them that one drags. The second one is a viewer with a session of its own, which the server draws for as for any other,
// so it is sharp when it may be, and reprojected meanwhile, as the first one is.

import { element } from '../page/parameter_fields.js';
import { strings } from '../page/strings.js';
import { compare as words } from '../page/strings/compare.js';
import { ToolCard } from '../page/cards/tool_card.js';
import { classesOf } from '../page/plan/legend.js';
import { styleKeys } from '../protocol/view_words.js';
import { pick } from '../view/usual.js';
import { wireOf } from '../view/camera_words.js';
import { wordsFor } from '../scancast-view.js';
import { Viewer } from '../view/viewer.js';
import { card } from './card.js';
import { otherColour, parseSides, printSides, rightStyle, usualSides } from './sides.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const step = { small: 2, large: 10 };
const names = ['cloud', 'method', 'color', 'shading', 'classes'];

export class Comparing extends ToolCard {
  #viewer;
  #page;
  #sides = /** @type {any} */ ({ ...usualSides });
  #isOn = false; // there are two pictures
  #other; // the viewer of the right side, made once: what it draws with is dear
  #side = element('div', { id: 'other-side', ariaHidden: 'true' }); // all that it draws on is in there, and cut off with it
  #divider = element('div', { id: 'divider', tabIndex: 0 });
  #styled = ''; // the style of the right side, as it was asked for last
  #trouble = ''; // why there is no picture of the right side
  #labels = [element('span', { className: 'side left' }), element('span', { className: 'side right' })];

  /** `page`: { overlays (messages), active(isActive), changed() (hears that the address has something new to say), title(method) } */
  constructor(viewer, page) {
    super({ card, words, active: page.active });
    this.#viewer = viewer;
    this.#page = page;
    this.#dress();
    for (const name of names) find(`compare-${name}`).addEventListener('change', ({ target: { value } }) => this.#choose(name, value));
    const on = (name, act) => viewer.addEventListener(name, ({ detail }) => this.#isOn && act(detail));
    on('camera', () => this.#follow());
    on('view', ({ by }) => by !== 'hand' && this.#restyle());
    on('connection', ({ kind }) => kind === 'locked' && this.#leave()); // what the next one may see, the next token says
    on('cloud', () => {
      this.#begin();
      this.#fill();
    });
    on('catalog', () => this.#fill());
    on('clouds', () => this.#fill());
  }

  /** Its card: what begins with that goes on without, until end(). */
  opened(isActive) {
    if (isActive && !this.#isOn) {
      const { view, cloud, catalog } = this.#viewer;
      const color = cloud && otherColour(view, cloud, catalog.colors ?? []);
      this.#sides = { ...usualSides, ...(color ? { color } : {}) };
      find('compare-begins').textContent = color ? words.begins(strings.colour.names[color]) : '';
      this.#start();
    }
    if (isActive) this.#fill();
  }

  /** As an address has it. */
  restoreHash(hash) {
    const sides = parseSides(hash);
    if (!sides) return;
    this.#sides = { ...sides };
    if (!this.#isOn) this.#start();
    else this.#begin();
    this.#fill();
  }

  /** '' or '&compare=…', for the address. */
  get hashPart() { return this.#isOn ? printSides(this.#sides) : ''; }

  // ---- beginning and end

  #start() {
    this.#isOn = true;
    document.body.classList.add('comparing');
    // Under what tools draw onto the picture. The hand goes through it, to the picture below.
    find('view').after(this.#side);
    find('marks').after(this.#divider, ...this.#labels);
    this.#other ??= this.#made();
    // Points are those of the left side; of what only the right one shows, none.
    this.#viewer.pickable = ({ x }) => (this.#sides.cloud === undefined && this.#sides.classes === undefined) || x <= (this.#sides.at / 100) * this.#viewer.cssSize.width;
    this.#begin();
    this.#place();
  }

  #made() {
    const canvas = element('canvas', { id: 'other-picture' });
    this.#side.append(canvas);
    const other = new Viewer(canvas, this.#viewer.server, new EventTarget());
    other.steerable = false;
    other.addEventListener('cloud', () => { // what was chosen while it was on its way
      this.#follow();
      other.changeStyle(this.#style, 'program');
    });
    other.addEventListener('frame', () => this.#isOn && other.cloud?.id === (this.#sides.cloud ?? this.#viewer.cloud?.id) && this.#side.classList.add('drawn'));
    const on = (name, act) => other.addEventListener(name, (/** @type {any} */ { detail }) => act(detail));
    on('problem', (detail) => this.#page.overlays.toast(words.problem, detail?.detail || detail?.title || ''));
    on('connection', (now) => {
      this.#trouble = now.kind === 'connecting' ? '' : wordsFor(now);
      if (now.kind !== 'open' && now.kind !== 'lost' && now.kind !== 'connecting') this.#side.classList.remove('drawn'); // what was there is of something else
      if (this.#isOn) this.#say();
    });
    return other;
  }

  /** The right side from its beginning: of this cloud or the other one, from where the left one looks. */
  #begin() {
    const { cloud, camera } = this.#viewer;
    if (!cloud || !camera) return;
    const place = { cloud: this.#sides.cloud ?? cloud.id, camera: this.#wire, upAxis: camera.upAxis, style: this.#style };
    if (this.#other.cloud) this.#other.restore(place);
    else this.#other.start(place);
    this.#say();
    this.#page.changed();
  }

  close() { this.end(); }

  end() {
    if (this.#isOn) {
      this.#isOn = false;
      this.#leave();
      this.#viewer.pickable = () => true;
      for (const node of [this.#side, this.#divider, ...this.#labels]) node.remove();
      document.body.classList.remove('comparing');
      this.#sides = { ...usualSides };
      this.#page.changed();
    }
    if (this.isActive) this.activate(false);
    else find('picture').focus({ preventScroll: true, focusVisible: false });
  }

  #leave() {
    this.#other.stop();
    this.#side.classList.remove('drawn');
  }

  // ---- the same camera, another look

  /** Of a camera in flight as well. */
  get #wire() { return wireOf(this.#viewer.camera, this.#viewer.bounds); }

  get #style() {
    const left = pick(this.#viewer.view, styleKeys);
    // Of another cloud, what only this one may have stays here.
    const style = this.#sides.cloud === undefined ? left : pick(left, ['method', 'param', 'color', 'colormap', 'range', 'shading', 'background', 'detail', 'light', 'exposure', 'clip', 'clips']);
    return rightStyle(style, this.#sides);
  }

  #follow() {
    if (this.#other?.camera) this.#other.changeCamera(this.#viewer.camera, 'program');
  }

  #restyle() {
    const style = JSON.stringify(this.#style);
    if (style === this.#styled) return; // a camera in flight tells of itself at every step
    this.#styled = style;
    if (this.#other?.cloud) this.#other.changeStyle(this.#style, 'program');
    this.#say();
  }

  #choose(name, value) {
    const chosen = value === '' ? undefined : name === 'classes' && value !== 'all' ? Number(value) : value;
    this.#sides = { ...this.#sides, [name]: chosen };
    find('compare-begins').textContent = '';
    if (name === 'cloud') this.#begin();
    else {
      this.#styled = '';
      this.#restyle();
    }
    this.#page.changed();
  }

  // ---- the card

  #fill() {
    const { catalog, cloud } = this.#viewer;
    if (!this.isActive || !cloud) return;
    const { methods = [], colors = [], shadings = [], clouds } = catalog;
    const nameOf = (color) => {
      const [source, by] = color.split('*');
      return [strings.colour.names[source] ?? source, by ? strings.colour.names.intensity ?? by : ''].filter(Boolean).join(' × ');
    };
    const options = {
      cloud: clouds.filter(({ id }) => id !== cloud.id).map(({ id, title }) => [id, title || id]),
      method: methods.map(({ name, title }) => [name, title || name]),
      color: colors.map((color) => [color, nameOf(color)]),
      shading: [['auto', strings.lighting.automatic], ...shadings.map((shading) => [shading, strings.lighting.names[shading] ?? shading])],
      classes: (cloud.classes ?? []).length > 0 ? [['all', words.allClasses], ...classesOf(cloud).map(({ number, name }) => [String(number), name])] : [],
    };
    for (const name of names) {
      const field = find(`compare-${name}`);
      field.replaceChildren(element('option', { value: '', textContent: words.same }), ...options[name].map(([value, textContent]) => element('option', { value, textContent })));
      field.value = String(this.#sides[name] ?? '');
      if (field.selectedIndex < 0) field.value = '';
      field.closest('label').hidden = options[name].length === 0;
    }
  }

  /** What each side shows, in its upper corner. */
  #say() {
    const { cloud, view, catalog } = this.#viewer;
    if (!cloud) return;
    const right = this.#style;
    const other = this.#sides.cloud && catalog.clouds.find(({ id }) => id === this.#sides.cloud);
    const partsOf = (style, shown) => [
      this.#sides.cloud ? shown?.title || shown?.id : '', this.#sides.method ? this.#page.title(style.method) : '',
      this.#sides.color ? strings.colour.names[style.color.split('*')[0]] ?? style.color : '',
      this.#sides.shading ? strings.lighting.names[style.shading] ?? strings.lighting.automatic : '',
      this.#sides.classes === undefined ? '' : style.classes ? classesOf(cloud).filter(({ number }) => style.classes.includes(number)).map(({ name }) => name).join(', ') : words.allClasses,
    ].filter(Boolean);
    const [left, rightLabel] = this.#labels;
    left.textContent = words.side(words.left, partsOf(view, cloud));
    rightLabel.textContent = this.#trouble || words.side(words.right, partsOf(right, other));
  }

  // ---- the divider

  #dress() {
    const divider = this.#divider;
    divider.append(element('i', { ariaHidden: 'true' }));
    for (const [name, value] of Object.entries({
      role: 'separator', 'aria-label': words.divider, 'aria-orientation': 'vertical', 'aria-valuemin': '0', 'aria-valuemax': '100',
    })) divider.setAttribute(name, value);
    let grabbed = false;
    divider.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      divider.setPointerCapture(event.pointerId);
      divider.focus({ preventScroll: true, focusVisible: false });
      grabbed = true;
    });
    divider.addEventListener('pointermove', (event) => {
      const { left, width } = find('picture').getBoundingClientRect();
      if (grabbed) this.#move(((event.clientX - left) / width) * 100);
    });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) divider.addEventListener(name, () => { grabbed = false; });
    divider.addEventListener('wheel', (event) => {
      event.preventDefault();
      find('picture').dispatchEvent(new WheelEvent(event.type, event));
    }, { passive: false });
    divider.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const by = event.shiftKey ? step.large : step.small;
      const to = {
        ArrowLeft: this.#sides.at - by, ArrowRight: this.#sides.at + by, ArrowDown: this.#sides.at - by, ArrowUp: this.#sides.at + by,
        PageDown: this.#sides.at - step.large, PageUp: this.#sides.at + step.large, Home: 0, End: 100,
      }[event.key];
      if (to === undefined) return;
      event.preventDefault(); // the camera would turn
      event.stopPropagation();
      this.#move(to);
    });
  }

  #move(to) {
    this.#sides = { ...this.#sides, at: Math.min(100, Math.max(0, Math.round(to * 10) / 10)) };
    this.#place();
    this.#page.changed();
  }

  #place() {
    const { at } = this.#sides;
    document.body.style.setProperty('--divider', String(at / 100));
    this.#divider.setAttribute('aria-valuenow', String(Math.round(at)));
    this.#divider.setAttribute('aria-valuetext', words.at(Math.round(at)));
  }
}
