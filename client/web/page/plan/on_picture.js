// What stands on the picture as it stands on a drawing: view cube, legend, overview map and scale bar, one above the other at the right
// side, and the grid under everything. Each can be switched off, and this browser remembers it. They follow what the canvas shows (the
// viewer's `shown`), and keep clear of whatever else floats over the picture, wherever that is in this window.

import { poseOf } from '../../view/pose.js';
import { focusOn, turnAbout } from '../../view/moves.js';
import { element } from '../parameter_fields.js';
import { planStrings } from '../strings/plan.js';
import { Grid, planAxis } from './grid.js';
import { Legend, legendOf } from './legend.js';
import { Minimap } from './minimap.js';
import { ScaleBar } from './scale_bar.js';
import { ViewCube } from './view_cube.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = planStrings.onPicture;
const key = 'scancast-on-picture';
const usual = { cube: true, scaleBar: true, legend: true, grid: false, minimap: false };
const gap = 8; // CSS pixels between them and what else floats there
/** What is left out, one after the other, where there is no room for all of them. */
const rooms = ['enough', 'no-map', 'no-legend', 'no-cube', 'none'];
const floating = '.title, .actions, .views, .card, #touring, #profile-panel, #hud, #rail, #credit, #lack, #loading, #hint, #leave-presentation';

/** What was chosen in this browser, whatever it kept. Pure. */
export function chosenOf(kept) {
  let known = {};
  try {
    known = JSON.parse(kept) ?? {};
  } catch {
    // Of another version, or by another hand.
  }
  return Object.fromEntries(Object.entries(usual).map(([name, value]) => [name, typeof known[name] === 'boolean' ? known[name] : value]));
}

/**
 * The stretch [top, bottom] of a column between left and right that none of the boxes lies over: below those that begin in the upper half
 * of `within`, above the others. Pure.
 */
export function freeStretch(boxes, { left, right }, within) {
  const middle = (within.top + within.bottom) / 2;
  let [top, bottom] = [within.top + gap, within.bottom - gap];
  for (const box of boxes) {
    if (box.right <= left || box.left >= right || box.bottom <= within.top || box.top >= within.bottom) continue;
    if ((box.top + box.bottom) / 2 < middle) top = Math.max(top, box.bottom + gap);
    else bottom = Math.min(bottom, box.top - gap);
  }
  return [top, bottom];
}

/** Whether the cloud's coordinate system says where north is. Pure. */
export const hasNorth = (cloud) => Boolean(cloud?.crsName || cloud?.crsEpsg);

function keptChoice() {
  try {
    return localStorage.getItem(key);
  } catch {
    return null; // storage may be forbidden
  }
}

export class OnPicture {
  #viewer;
  #chosen = chosenOf(keptChoice());
  #cube;
  #plan = element('button', { type: 'button', id: 'plan-view', textContent: planStrings.cube.plan, title: planStrings.cube.planTip });
  #legend = new Legend();
  #minimap;
  #scaleBar = new ScaleBar();
  #grid = new Grid();
  #column = element('div', { id: 'on-picture' });
  #boxes = new Map(); // name → checkbox in the panel
  #note = element('p', { className: 'note', textContent: words.gridNote });
  #ramps;
  #stats;
  #before; // the camera before the plan
  #taken = []; // boxes of what floats over the picture, from its top left corner
  #placing = false;
  #watcher = new ResizeObserver(() => this.#placeSoon());
  #watched = new WeakSet();
  #shown; // the pose that was shown last

  constructor(viewer) {
    this.#viewer = viewer;
    let held; // the point about which a drag of the cube turns
    this.#cube = new ViewCube((turn) => this.#turn(turn), {
      begin: () => { held = this.#middle ?? viewer.camera?.target; },
      turn: (azimuth, elevation) => viewer.camera && held && viewer.changeCamera(turnAbout(viewer.camera, held, azimuth, elevation)),
    });
    this.#minimap = new Minimap(viewer);
    this.#plan.addEventListener('click', () => this.togglePlan());
    this.#column.append(element('div', { id: 'cube-place' }, this.#cube.node, this.#plan), this.#legend.node, element('span', { className: 'space' }),
      this.#minimap.node, this.#scaleBar.node);
    find('view').after(this.#grid.node);
    find('marks').after(this.#column); // above what tools draw onto the picture
    this.#fillPanel();
    this.#apply();
    for (const node of [find('picture'), ...this.#column.children]) this.#watch(node);
    this.#place();
    const changes = new MutationObserver(() => this.#placeSoon());
    changes.observe(document.body, { attributes: true, attributeFilter: ['class', 'data-sheet'] });
    changes.observe(find('hint'), { attributes: true, attributeFilter: ['class'] });
    find('hint').addEventListener('transitionend', () => this.#placeSoon());
    for (const name of ['shown', 'cloud']) viewer.addEventListener(name, () => this.#show());
    viewer.addEventListener('catalog', ({ detail }) => { this.#ramps = detail.ramps; });
    viewer.addEventListener('stats', ({ detail }) => {
      this.#stats = detail;
      this.#showLegend();
    });
    viewer.addEventListener('begin', () => {
      this.#stats = this.#before = undefined;
    });
    viewer.addEventListener('cloud', () => this.#minimap.renew());
    viewer.addEventListener('view', ({ detail }) => {
      if (detail.by === 'hand') return;
      this.#showLegend();
      this.#minimap.renew();
    });
  }

  /** 'cube', 'scaleBar', 'legend', 'grid' or 'minimap', on or off. */
  toggle(name) {
    this.#choose(name, !this.#chosen[name]);
  }

  /** All of the cloud from the top without perspective; from there, back to where one was. */
  togglePlan() {
    const { camera } = this.#viewer;
    if (!camera) return;
    if (!this.#isPlan) {
      this.#before = camera;
      this.#viewer.showPlan('top');
    } else if (this.#before && this.#before.upAxis === camera.upAxis) this.#viewer.goTo(this.#before);
    else this.#viewer.showStandardView('first');
  }

  get #isPlan() {
    const { camera } = this.#viewer;
    return camera?.projection === 'orthographic' && Math.PI / 2 - camera.elevation < 1e-6;
  }

  /** About what is seen in the middle of the picture. */
  #turn(turn) {
    const { camera, destination } = this.#viewer;
    if (!camera) return;
    const point = destination === camera ? this.#middle : undefined; // in flight, it is what it was
    this.#viewer.goTo(turn(point ? focusOn(camera, point) : destination));
  }

  get #middle() {
    const { width, height } = this.#viewer.cssSize;
    return this.#viewer.surfaceAt({ x: width / 2, y: height / 2 })?.point;
  }

  #choose(name, on) {
    this.#chosen = { ...this.#chosen, [name]: on };
    try {
      localStorage.setItem(key, JSON.stringify(this.#chosen));
    } catch {
      // Then it holds until the page is left.
    }
    this.#apply();
  }

  #fillPanel() {
    const rows = Object.keys(usual).map((name) => {
      const box = element('input', { type: 'checkbox', id: `on-picture-${name}` });
      box.addEventListener('change', () => this.#choose(name, box.checked));
      this.#boxes.set(name, box);
      return element('div', { className: 'row check' }, box, element('label', { htmlFor: box.id, textContent: words[name] }));
    });
    find('on-picture-choices').replaceChildren(element('h3', { textContent: words.title }), ...rows, this.#note);
  }

  #apply() {
    for (const [name, box] of this.#boxes) box.checked = this.#chosen[name];
    find('cube-place')?.toggleAttribute('hidden', !this.#chosen.cube);
    this.#minimap.node.hidden = !this.#chosen.minimap;
    this.#minimap.renew();
    this.#shown = undefined;
    this.#show();
    this.#showLegend();
  }

  get #colours() {
    const { view, cloud, catalog } = this.#viewer;
    return cloud ? { view, cloud, ramps: this.#ramps, stats: this.#stats, clouds: catalog.clouds } : {};
  }

  /** What the legend of the picture says (legendOf()), shown or not; undefined where colours need no words. */
  get legend() {
    return legendOf(this.#colours);
  }

  #showLegend() {
    this.#legend.show(this.#chosen.legend ? this.#colours : {});
  }

  /** As the canvas shows the cloud now. */
  #show() {
    const { camera, cloud, bounds, cssSize: size } = this.#viewer;
    if (!camera || !cloud) return;
    const pose = this.#viewer.shownPose ?? poseOf(camera, bounds, size.width / size.height);
    const known = JSON.stringify([pose.eye, pose.axes, pose.halfHeight, pose.stretch, pose.orthographic, size, cloud.id, this.#taken.length]);
    // What lies in the middle is known better with each picture; the rest is as it was.
    if (this.#chosen.scaleBar) this.#showScaleBar(pose, size, cloud);
    else this.#scaleBar.node.hidden = true;
    if (known === this.#shown) return;
    this.#shown = known;
    const { upAxis } = camera;
    const north = hasNorth(cloud);
    if (this.#chosen.cube) this.#cube.show({ axes: pose.axes, upAxis, hasNorth: north });
    this.#plan.setAttribute('aria-pressed', String(this.#isPlan));
    if (this.#chosen.grid) this.#grid.show({ pose, size, upAxis, hasNorth: north, taken: this.#taken });
    else this.#grid.node.toggleAttribute('hidden', true);
    this.#note.hidden = !this.#chosen.grid || planAxis(pose) !== undefined;
    if (this.#chosen.minimap) this.#minimap.show({ pose, size });
  }

  #showScaleBar(pose, size, cloud) {
    const depth = pose.orthographic ? undefined : this.#viewer.surfaceAt({ x: size.width / 2, y: size.height / 2 })?.depth;
    this.#scaleBar.show({ pose, size, depth, crsUnit: cloud.crsUnit });
  }

  /** Also what a tool has brought along since. */
  #watch(node) {
    if (this.#watched.has(node)) return;
    this.#watched.add(node);
    this.#watcher.observe(node);
  }

  #placeSoon() {
    if (this.#placing) return;
    this.#placing = true;
    requestAnimationFrame(() => {
      this.#placing = false;
      this.#place();
    });
  }

  /** Between what floats over the picture at its right side. */
  #place() {
    const picture = find('picture').getBoundingClientRect();
    const isSeen = (node) => node.id !== 'hint' || getComputedStyle(node).opacity !== '0'; // it fades once it is learned
    const nodes = [...document.querySelectorAll(floating)];
    nodes.forEach((node) => this.#watch(node));
    const boxes = nodes.filter(isSeen).map((node) => node.getBoundingClientRect()).filter(({ width, height }) => width > 0 && height > 0);
    const { left, right } = this.#column.getBoundingClientRect();
    const [top, bottom] = freeStretch(boxes, { left, right }, picture);
    this.#column.style.top = `${top}px`;
    this.#column.style.height = `${Math.max(0, bottom - top)}px`;
    for (const room of rooms) {
      this.#column.dataset.room = room;
      if (this.#column.scrollHeight <= this.#column.clientHeight) break;
    }
    this.#taken = [...boxes, ...[...this.#column.children].map((node) => node.getBoundingClientRect()).filter(({ width }) => width > 0)]
      .map((box) => ({ left: box.left - picture.left - 4, right: box.right - picture.left + 4, top: box.top - picture.top - 4, bottom: box.bottom - picture.top + 4 }));
    this.#shown = undefined;
    this.#show();
  }
}
