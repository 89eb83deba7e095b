// What stands on a picture that is saved as it stands on a drawing: scale bar, legend, north, title and whose the scan is, drawn onto a canvas
// at its own resolution. What they say comes from where the page's own come from (page/plan/); here is only how a canvas shows it.

import { legendLines, legendTitle } from '../page/plan/legend.js';
import { scaleBarOf, unitsPerPixel } from '../page/plan/scale_bar.js';
import { planStrings } from '../page/strings/plan.js';
import { toCloud } from '../view/camera.js';
import { dot } from '../view/vectors.js';

const paper = 'rgb(15 18 22 / 72%)'; // dark in both themes, as pictures are
const ink = '#fff';
const family = 'system-ui, sans-serif';
const leastNorth = 0.12; // of the way north across the picture: less is a direction into it

/** Pixels of a line of text, whatever the picture's size. Pure. */
export const textSize = ({ width, height }) => Math.max(11, Math.min(0.021 * Math.min(width, height), 0.03 * width));

/**
 * Where north is on a picture: { x, y }, x to the right and y downwards, of length 1; undefined where it lies along the view direction. Pure.
 * @param {import('../view/pose.js').Pose} pose
 */
export function northOn(pose, upAxis) {
  const north = toCloud([0, 1, 0], upAxis);
  const [x, y] = [dot(north, pose.axes.right), -dot(north, pose.axes.up)];
  const far = Math.hypot(x, y);
  return far >= leastNorth ? { x: x / far, y: y / far } : undefined;
}

/** What the scale bar of a picture says, at most a sixth of it wide: { pixels, text, where }; undefined where there is no scale. Pure. */
export function scaleOn(pose, size, { depth, crsUnit }) {
  const perPixel = unitsPerPixel(pose, size.height, depth ?? pose.distance);
  if (!(perPixel > 0 && Number.isFinite(perPixel))) return undefined;
  const { pixels, text } = scaleBarOf(perPixel, crsUnit, size.width / 6);
  return { pixels, text, where: pose.orthographic ? '' : depth === undefined ? planStrings.scale.target : planStrings.scale.centre };
}

class Painter {
  #context;
  #size;
  #em;

  constructor(context, size) {
    this.#context = context;
    this.#size = size;
    this.#em = textSize(size);
    context.textBaseline = 'alphabetic';
    context.lineJoin = 'round';
  }

  get #gap() { return this.#em; }

  #font(factor = 1, weight = 400) {
    this.#context.font = `${weight} ${(this.#em * factor).toFixed(1)}px ${family}`;
  }

  #sheet(x, y, width, height) {
    this.#context.fillStyle = paper;
    this.#context.beginPath();
    this.#context.roundRect(x, y, width, height, 0.5 * this.#em);
    this.#context.fill();
    this.#context.fillStyle = ink;
  }

  /** In lines that are no wider than that, at most `most` of them. */
  #wrapped(text, width, most) {
    const lines = [''];
    for (const word of String(text).split(/\s+/)) {
      const longer = lines.at(-1) ? `${lines.at(-1)} ${word}` : word;
      if (this.#context.measureText(longer).width <= width || !lines.at(-1)) lines[lines.length - 1] = longer;
      else if (lines.length < most) lines.push(word);
      else {
        lines[lines.length - 1] += ' …';
        break;
      }
    }
    return lines;
  }

  /** At the lower left. */
  credit({ title, credit }) {
    const em = this.#em;
    const widest = 0.5 * this.#size.width;
    this.#font(1.2, 600);
    const titles = title ? this.#wrapped(title, widest, 2) : [];
    let wide = Math.max(0, ...titles.map((line) => this.#context.measureText(line).width));
    this.#font(0.85);
    const lines = credit ? this.#wrapped(credit, widest, 3) : [];
    wide = Math.max(wide, ...lines.map((line) => this.#context.measureText(line).width));
    if (titles.length + lines.length === 0) return;
    const high = (titles.length * 1.5 + lines.length * 1.2 + 0.6) * em;
    const [x, y] = [this.#gap, this.#size.height - this.#gap - high];
    this.#sheet(x, y, wide + 1.4 * em, high);
    let line = y + 0.15 * em;
    this.#font(1.2, 600);
    for (const text of titles) this.#context.fillText(text, x + 0.7 * em, (line += 1.4 * em));
    this.#font(0.85);
    for (const text of lines) this.#context.fillText(text, x + 0.7 * em, (line += 1.2 * em));
  }

  /** At the lower right. Returns how high it stands. */
  scale({ pixels, text, where }) {
    const em = this.#em;
    this.#font();
    const words = [text, where].filter(Boolean).join(' ');
    const wide = Math.max(pixels, this.#context.measureText(words).width) + 1.4 * em;
    const high = 2.5 * em;
    const [x, y] = [this.#size.width - this.#gap - wide, this.#size.height - this.#gap - high];
    this.#sheet(x, y, wide, high);
    this.#context.textAlign = 'right';
    this.#context.fillText(words, x + wide - 0.7 * em, y + 1.25 * em);
    this.#context.textAlign = 'left';
    const [left, right, level] = [x + wide - 0.7 * em - pixels, x + wide - 0.7 * em, y + 1.95 * em];
    this.#context.strokeStyle = ink;
    this.#context.lineWidth = Math.max(1.5, 0.12 * em);
    this.#context.beginPath();
    this.#context.moveTo(left, level - 0.35 * em);
    this.#context.lineTo(left, level);
    this.#context.lineTo(right, level);
    this.#context.lineTo(right, level - 0.35 * em);
    this.#context.stroke();
    return high;
  }

  /** At the upper right. */
  legend(legend) {
    const em = this.#em;
    const title = legendTitle(legend);
    const lines = legendLines(legend);
    this.#font(0.95, 600);
    let wide = this.#context.measureText(title).width;
    this.#font(0.9);
    const ramp = legend.colors && 9 * em;
    for (const { text } of lines) wide = Math.max(wide, this.#context.measureText(text).width + (ramp ? 0 : 1.5 * em));
    if (ramp) wide = Math.max(wide, ramp, legend.ends.reduce((sum, end) => sum + this.#context.measureText(end).width, 2 * em));
    const room = Math.max(2, Math.floor((0.75 * this.#size.height) / (1.3 * em)) - 3);
    const rows = lines.length <= room ? lines : [...lines.slice(0, room - 1), { text: planStrings.legend.more(lines.length - room + 1 + Math.max(0, (legend.more ?? 0) - 1)) }];
    const high = (1.9 + (ramp ? 2.3 : 0) + rows.length * 1.3) * em;
    const [x, y] = [this.#size.width - this.#gap - wide - 1.4 * em, this.#gap];
    this.#sheet(x, y, wide + 1.4 * em, high);
    this.#font(0.95, 600);
    this.#context.fillText(title, x + 0.7 * em, y + 1.3 * em);
    let line = y + 1.75 * em;
    if (ramp) {
      this.#ramp(legend, x + 0.7 * em, line, wide, 0.9 * em);
      this.#font(0.9);
      this.#context.fillText(legend.ends[0], x + 0.7 * em, line + 1.9 * em);
      this.#context.textAlign = 'right';
      this.#context.fillText(legend.ends[1], x + 0.7 * em + wide, line + 1.9 * em);
      this.#context.textAlign = 'left';
      line += 2.3 * em;
    }
    this.#font(0.9);
    for (const { text, color } of rows) {
      if (color) {
        this.#context.fillStyle = color;
        this.#context.fillRect(x + 0.7 * em, line + 0.1 * em, em, 0.9 * em);
        this.#context.fillStyle = ink;
      }
      this.#context.fillText(text, x + (color ? 2.2 : 0.7) * em, line + 0.9 * em);
      line += 1.3 * em;
    }
  }

  #ramp({ colors, isStepped }, x, y, width, height) {
    if (isStepped) {
      colors.forEach((color, i) => {
        this.#context.fillStyle = color;
        this.#context.fillRect(x + (width * i) / colors.length, y, width / colors.length + 1, height);
      });
    } else {
      const gradient = this.#context.createLinearGradient(x, 0, x + width, 0);
      colors.forEach((color, i) => gradient.addColorStop(i / Math.max(1, colors.length - 1), color));
      this.#context.fillStyle = gradient;
      this.#context.fillRect(x, y, width, height);
    }
    this.#context.fillStyle = ink;
  }

  /** At the upper left: an arrow to where north is. */
  north({ x, y }, name) {
    const em = this.#em;
    const radius = 2.2 * em;
    const [cx, cy] = [this.#gap + radius, this.#gap + radius];
    const context = this.#context;
    context.fillStyle = paper;
    context.beginPath();
    context.arc(cx, cy, radius, 0, 2 * Math.PI);
    context.fill();
    const at = (along, across) => [cx + (x * along - y * across) * em, cy + (y * along + x * across) * em];
    context.fillStyle = ink;
    context.beginPath();
    for (const [along, across] of [[0.8, 0], [-1.5, 0.7], [-1, 0], [-1.5, -0.7]]) context.lineTo(...at(along, across));
    context.fill();
    this.#font(1, 700);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(name, ...at(1.45, 0));
    context.textAlign = 'left';
    context.textBaseline = 'alphabetic';
  }
}

/**
 * Puts onto a picture of `size` what is wanted of it: `parts` has, each where it is to stand there, `scale` as scaleOn() says it, `legend` as
 * legendOf() (page/plan/legend.js), `north` as northOn() and `credit`, { title, credit }.
 */
export function drawFurniture(context, size, { scale, legend, north, credit }) {
  const painter = new Painter(context, size);
  if (credit) painter.credit(credit);
  if (scale) painter.scale(scale);
  if (legend) painter.legend(legend);
  if (north) painter.north(north, planStrings.cube.north);
}
