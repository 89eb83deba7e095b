// The overview map: a small picture of the cloud from the top, drawn by the server once for each look of it, with what the large picture
// shows of it upon it. A click or a drag goes there.

import { axes, fit, pointUnderCursor, project, standardView, toProtocol, upwards } from '../../view/camera.js';
import { add, dot, scale, subtract } from '../../view/vectors.js';
import { element } from '../parameter_fields.js';
import { planStrings } from '../strings/plan.js';
import { styleKeys } from '../../protocol/view_words.js';
import { svg } from './svg.js';

const words = planStrings.minimap;
const restMs = 350; // after the last change of style
const quality = 80;
const box = { width: 176, height: 132 }; // CSS pixels, at most
const farthestParts = 3; // of the distance to what is looked at: what lies farther is not drawn

/** { width, height } of a map of that extent, as large as it fits into `most`. Pure. */
export function mapSize(across, down, most = box) {
  const shape = Math.min(4, Math.max(0.25, across / down || 1));
  const width = Math.min(most.width, most.height * shape);
  return { width: Math.round(width), height: Math.round(width / shape) };
}

/** The camera, from the top, that shows all of a map of `bounds`, and the map's size. Pure. */
export function mapOf(bounds, upAxis) {
  const start = { target: [0, 0, 0], azimuth: 0, elevation: 0, distance: 1, fov: 60, projection: 'orthographic', upAxis };
  const { right, up } = axes(standardView(start, 'top', bounds, box));
  const extent = (axis) => Math.abs(dot(subtract(bounds.max, bounds.min), axis.map(Math.abs)));
  const size = mapSize(extent(right), extent(up));
  return { size, camera: fit(standardView(start, 'top', bounds, size), bounds, size, size, 1.02) };
}

/**
 * What a picture shows of the map: { eye: [x, y] - undefined without perspective -, outline: four [x, y] } in the map's pixels: where the
 * rays through its corners meet the level of what is looked at, or end. Pure.
 */
export function shownOnMap(map, pose, aspect) {
  const onMap = (point) => {
    const { x, y } = project(map.camera, point, map.size);
    return [x, y];
  };
  const { right, up, back } = pose.axes;
  const half = pose.halfHeight / pose.stretch;
  const upright = upwards(map.camera);
  const target = subtract(pose.eye, scale(back, pose.distance));
  const outline = [[-1, 1], [1, 1], [1, -1], [-1, -1]].map(([i, j]) => {
    const aside = add(scale(right, i * half * aspect), scale(up, j * half));
    if (pose.orthographic) return onMap(add(target, aside));
    const ray = subtract(aside, back);
    const down = dot(ray, upright);
    const level = dot(subtract(target, pose.eye), upright);
    const reach = Math.abs(down) > 1e-9 ? level / down : Infinity;
    return onMap(add(pose.eye, scale(ray, reach > 0 ? Math.min(reach, farthestParts * pose.distance) : farthestParts * pose.distance)));
  });
  return { eye: pose.orthographic ? undefined : onMap(pose.eye), outline };
}

/** `camera` moved level, until what it looks at lies at that pixel of the map. Pure. */
export function movedTo(camera, map, pixel) {
  const upright = upwards(map.camera);
  const way = subtract(pointUnderCursor(map.camera, pixel, map.size), camera.target);
  return { ...camera, target: add(camera.target, subtract(way, scale(upright, dot(way, upright)))) };
}

const path = (places) => `M${places.map((place) => place.map((value) => Math.max(-9999, Math.min(9999, value)).toFixed(1)).join(' ')).join('L')}Z`;

export class Minimap {
  #viewer;
  #map;
  #of = ''; // what the picture is of
  #loading; // AbortController
  #soon;
  #picture = element('img', { alt: '', draggable: false });
  #beyond = svg('path', { class: 'beyond' });
  #outline = svg('path', { class: 'outline' });
  #eye = svg('circle', { class: 'eye', r: 3.5 });
  #drawing = svg('svg', {}, this.#beyond, this.#outline, this.#eye);
  #failed = element('p', { className: 'note', hidden: true, textContent: words.failed });
  node = element('div', { id: 'minimap', title: words.tip }, this.#picture, this.#drawing, this.#failed);

  constructor(viewer) {
    this.#viewer = viewer;
    this.node.setAttribute('role', 'img');
    this.node.setAttribute('aria-label', words.label);
    const pixelOf = ({ clientX, clientY }) => {
      const { left, top, width, height } = this.#drawing.getBoundingClientRect();
      return { x: ((clientX - left) * this.#map.size.width) / width, y: ((clientY - top) * this.#map.size.height) / height };
    };
    let held = false, moved = false;
    this.node.addEventListener('pointerdown', (event) => {
      if (!this.#map || event.button !== 0) return;
      this.node.setPointerCapture(event.pointerId);
      [held, moved] = [true, false];
      event.preventDefault();
    });
    this.node.addEventListener('pointermove', (event) => {
      if (!held || (event.movementX === 0 && event.movementY === 0)) return;
      moved = true;
      if (viewer.camera) viewer.changeCamera(movedTo(viewer.camera, this.#map, pixelOf(event)));
    });
    this.node.addEventListener('pointerup', (event) => {
      if (held && !moved && viewer.camera) viewer.goTo(movedTo(viewer.camera, this.#map, pixelOf(event)), 'hand');
      held = false;
    });
    this.node.addEventListener('pointercancel', () => { held = false; });
  }

  /** The picture is of another cloud, or another look of it; asked for while it is to be seen, after a moment without changes. */
  renew() {
    clearTimeout(this.#soon);
    this.#soon = setTimeout(() => this.#load(), this.#map ? restMs : 0);
  }

  async #load() {
    const { cloud, view, server, camera } = this.#viewer;
    if (!cloud?.bounds || !camera || this.node.hidden) return;
    const style = Object.fromEntries(styleKeys.map((key) => [key, view[key] ?? null]));
    const of = JSON.stringify([cloud.id, cloud.revision, camera.upAxis, style]);
    if (of === this.#of) return;
    this.#of = of;
    this.#loading?.abort();
    const loading = new AbortController();
    this.#loading = loading;
    const bounds = cloud.look?.bounds ?? cloud.bounds;
    const map = mapOf(bounds, camera.upAxis);
    const ratio = Math.min(2, Math.max(1, devicePixelRatio));
    const pixels = { width: Math.round(map.size.width * ratio), height: Math.round(map.size.height * ratio) };
    try {
      const asked = { ...style, detail: null, quality, camera: toProtocol(map.camera, cloud.bounds) };
      const blob = await server.snapshot(cloud.id, asked, pixels, { format: 'jpg', signal: loading.signal });
      if (loading !== this.#loading) return;
      URL.revokeObjectURL(this.#picture.src);
      this.#picture.src = URL.createObjectURL(blob);
      this.#adopt(map);
      this.#failed.hidden = true;
    } catch {
      if (loading !== this.#loading) return;
      this.#of = ''; // asked for again with the next change
      this.#failed.hidden = this.#map !== undefined;
    }
  }

  #adopt(map) {
    this.#map = map;
    const { width, height } = map.size;
    for (const node of [this.#picture, this.#drawing]) {
      node.style.width = `${width}px`;
      node.style.height = `${height}px`;
    }
    this.#drawing.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.show(this.#shown);
  }

  #shown;

  /** What the large picture shows: { pose, size }. */
  show(shown) {
    this.#shown = shown;
    if (!this.#map || !shown) return;
    if (this.#viewer.camera.upAxis !== this.#map.camera.upAxis) this.renew(); // another side of the cloud is its top now
    const { eye, outline } = shownOnMap(this.#map, shown.pose, shown.size.width / shown.size.height);
    const { width, height } = this.#map.size;
    this.#outline.setAttribute('d', path(outline));
    this.#beyond.setAttribute('d', `${path(outline)}M0 0H${width}V${height}H0Z`);
    this.#eye.toggleAttribute('hidden', !eye);
    if (!eye) return;
    // One that is outside stands at the border, hollow.
    const [x, y] = [[eye[0], width], [eye[1], height]].map(([at, most]) => Math.min(most - 5, Math.max(5, at)));
    this.#eye.setAttribute('cx', x.toFixed(1));
    this.#eye.setAttribute('cy', y.toFixed(1));
    this.#eye.classList.toggle('outside', x !== eye[0] || y !== eye[1]);
  }
}
