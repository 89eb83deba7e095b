// Measures as they lie over the picture: lines and points in one SVG, values in labels beside them, as sharp as the display is. They
// are placed anew whenever what is on the canvas looks from elsewhere, by the pose that is shown, between frames as well. What
// is behind something is drawn faintly, and its labels go: judged once for each frame, by the depth that it brought.

import { svgIn } from '../page/plan/svg.js';
import { mix } from '../view/vectors.js';
import { isCovered, nearestTo, Places } from './places.js';
import { figureOf, kinds } from './values.js';

const piecesOfLine = 12;
const piecesOfHelper = 4;
/** Lines of more points than this are curves: each of their parts is one piece. */
const fewPoints = 12;
const lift = 12; // px of a label above its point

const judged = (at) => ({ at, hidden: false, doubt: 0 });

/** A line of points in pieces, each of which is to be seen or not. */
function pieces(line, each) {
  const count = line.length > fewPoints ? 1 : each;
  return line.slice(1).flatMap((to, i) => Array.from({ length: count }, (_, k) => {
    const [a, b] = [mix(line[i], to, k / count), mix(line[i], to, (k + 1) / count)];
    return { ...judged(mix(a, b, 0.5)), from: a, to: b };
  }));
}

const px = (number) => number.toFixed(2);

/** The pieces for which `hidden` is that, as a path; what hangs together is one line. */
function pathOf(parts, hidden, places) {
  let path = '';
  let end;
  for (const part of parts) {
    const line = part.hidden === hidden ? places.line(part.from, part.to) : undefined;
    if (!line) {
      end = undefined;
      continue;
    }
    const [a, b] = line;
    const joins = end && Math.abs(end.x - a.x) + Math.abs(end.y - a.y) < 0.01;
    path += `${joins ? '' : `M${px(a.x)} ${px(a.y)}`}L${px(b.x)} ${px(b.y)}`;
    end = b;
  }
  return path;
}

/** One measure's elements. */
class Mark {
  measure;
  look;
  #group;
  #paths;
  #lines;
  #helpers;
  dots;
  middles;
  labels;

  /** `look`: { selected, drawn (by the hand, just now), pending (which points are not picked yet), text and leg(length) (a label's words), heights (as for figureOf()), figure (in place of what figureOf() says) } */
  constructor(measure, look, layers) {
    this.measure = measure;
    this.look = look;
    const { lines, helpers, label, legs } = look.figure ?? figureOf(measure, look.heights);
    this.#lines = lines.flatMap((line) => pieces(line, piecesOfLine));
    this.#helpers = helpers.flatMap((line) => pieces(line, piecesOfHelper));
    this.#group = svgIn(layers.svg, 'g', `measure${look.selected ? ' selected' : ''}${look.drawn ? ' drawn' : ''}`);
    this.#paths = Object.fromEntries(['fill', 'halo', 'behind', 'helper', 'line'].map((name) => [name, svgIn(this.#group, 'path', name)]));
    this.dots = measure.points.map((point, i) => this.#handle(point, `point${look.pending?.[i] ? ' pending' : ''}`, i));
    this.middles = look.selected && !kinds[measure.kind].fits && measure.points.length < kinds[measure.kind].most ? this.#middles() : [];
    this.labels = [
      ...(look.text ? [this.#label(label, look.text, 'value', layers.labels)] : []),
      ...(look.selected || look.drawn ? legs.map(({ at, length }) => this.#label(at, look.leg(length), 'leg', layers.labels)) : []),
    ];
  }

  #handle(point, className, index) {
    const node = svgIn(this.#group, 'g', `handle ${className}`);
    node.dataset.measure = String(this.measure.id);
    node.dataset.index = String(index);
    svgIn(node, 'circle', 'reach');
    svgIn(node, 'circle', 'dot');
    return { ...judged(point), node };
  }

  /** Between two points: where one more can be drawn out of the line. */
  #middles() {
    const { points, kind } = this.measure;
    const next = kinds[kind].closed ? [...points, points[0]] : points;
    return next.slice(1).map((to, i) => this.#handle(mix(next[i], to, 0.5), 'middle', i + 1));
  }

  #label(at, text, className, parent) {
    const node = document.createElement('div');
    node.className = `label ${className}${this.look.selected ? ' selected' : ''}`;
    node.textContent = text;
    node.dataset.measure = String(this.measure.id);
    parent.append(node);
    return { ...judged(at), node, width: node.offsetWidth, height: node.offsetHeight };
  }

  /** What of it is behind something; a moving picture, which has gaps, must say so twice. */
  judge(seen, spacing, isStill) {
    for (const one of [...this.#lines, ...this.#helpers, ...this.dots, ...this.labels]) {
      const hidden = isCovered(seen, one.at, spacing, one.hidden);
      one.doubt = hidden === one.hidden ? 0 : one.doubt + 1;
      if (one.doubt > 0 && (isStill || one.doubt > 1)) [one.hidden, one.doubt] = [hidden, 0];
    }
  }

  place(places, { width, height }) {
    const seen = pathOf(this.#lines, false, places);
    const paths = {
      line: seen, halo: seen, behind: pathOf(this.#lines, true, places) + pathOf(this.#helpers, true, places),
      helper: pathOf(this.#helpers, false, places), fill: kinds[this.measure.kind].closed ? this.#outline(places) : '',
    };
    for (const [name, path] of Object.entries(paths)) this.#paths[name].setAttribute('d', path);
    for (const one of [...this.dots, ...this.middles]) {
      const at = places.of(one.at);
      one.node.style.display = at ? '' : 'none';
      one.node.classList.toggle('hidden', one.hidden);
      if (at) one.node.setAttribute('transform', `translate(${px(at.x)} ${px(at.y)})`);
    }
    const grain = 1 / (devicePixelRatio || 1);
    const whole = (value) => Math.round(value / grain) * grain;
    for (const { at, node, hidden, width: wide, height: high } of this.labels) {
      const on = places.of(at);
      const isOn = on && on.x > -wide && on.y > -high && on.x < width + wide && on.y < height + high + lift;
      node.classList.toggle('hidden', hidden);
      node.style.display = isOn ? '' : 'none';
      if (isOn) node.style.translate = `${whole(on.x - wide / 2)}px ${whole(on.y - high - (node.classList.contains('leg') ? 4 : lift))}px`;
    }
  }

  #outline(places) {
    const at = this.measure.points.map((point) => places.of(point));
    return at.length > 2 && at.every(Boolean) ? `M${at.map(({ x, y }) => `${px(x)} ${px(y)}`).join('L')}Z` : '';
  }

  remove() {
    this.#group.remove();
    for (const { node } of this.labels) node.remove();
  }
}

export class Marks {
  #root;
  #viewer;
  #layers;
  #ring;
  #marks = new Map();
  #at; // where the surface under the hand is
  #pose;
  #size = '';

  /** In `root`, which lies over the picture; `viewer` tells when what is shown looks from elsewhere. */
  constructor(root, viewer) {
    this.#root = root;
    this.#viewer = viewer;
    const drawing = svgIn(root, 'svg');
    const labels = document.createElement('div');
    labels.className = 'labels';
    root.append(labels);
    this.#layers = { svg: drawing, labels };
    this.#ring = svgIn(drawing, 'circle', 'ring');
    viewer.addEventListener('shown', () => this.place());
    viewer.addEventListener('frame', ({ detail }) => this.#judge(Boolean(detail.final || detail.still)));
    new ResizeObserver(() => this.place(true)).observe(root);
  }

  get root() { return this.#root; }

  /** `list`: [{ measure, look }] as Mark has them, a measure's `id` telling which is which. */
  show(list) {
    const kept = new Map();
    for (const { measure, look } of list) {
      const known = this.#marks.get(measure.id);
      const isSame = known?.measure === measure && known.look.key === look.key;
      if (known && !isSame) known.remove();
      kept.set(measure.id, isSame ? known : this.#made(measure, look));
      this.#marks.delete(measure.id);
    }
    for (const gone of this.#marks.values()) gone.remove();
    this.#marks = kept;
    this.place(true);
  }

  #made(measure, look) {
    const mark = new Mark(measure, look, this.#layers);
    if (!look.drawn) mark.judge(this.#viewer.seen, this.#spacing, true);
    return mark;
  }

  get #spacing() { return this.#viewer.cloud?.spacing ?? 0; }

  /** Where the hand would take hold of the surface; undefined for nowhere. */
  point(at) {
    this.#at = at;
    this.#ring.style.display = at ? '' : 'none';
    this.place(true);
  }

  #judge(isStill) {
    for (const mark of this.#marks.values()) if (!mark.look.drawn) mark.judge(this.#viewer.seen, this.#spacing, isStill);
    this.place(true);
  }

  place(anyway = false) {
    const { shownPose, cssSize } = this.#viewer;
    const size = `${cssSize.width} ${cssSize.height}`;
    if (!anyway && shownPose === this.#pose && size === this.#size) return;
    this.#pose = shownPose;
    this.#size = size;
    this.#root.style.visibility = shownPose ? '' : 'hidden';
    if (!shownPose) return;
    const places = new Places(shownPose, cssSize);
    for (const mark of this.#marks.values()) mark.place(places, cssSize);
    const ring = this.#at && places.of(this.#at);
    this.#ring.style.display = ring ? '' : 'none';
    if (ring) this.#ring.setAttribute('transform', `translate(${px(ring.x)} ${px(ring.y)})`);
  }

  /** The point of a measure that is within `reach` px of the cursor: { id, index }. */
  near(cursor, reach) {
    const { shownPose, cssSize } = this.#viewer;
    if (!shownPose) return undefined;
    const places = new Places(shownPose, cssSize);
    const all = [...this.#marks.values()].filter(({ look }) => !look.drawn)
      .flatMap(({ measure }) => measure.points.map((point, index) => ({ id: measure.id, index, at: places.of(point) })));
    const found = nearestTo(all.map(({ at }) => at), cursor, reach);
    return found < 0 ? undefined : { id: all[found].id, index: all[found].index };
  }
}
