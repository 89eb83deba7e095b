// The canvas: sizes it, and draws frames on it in their order. A frame that is older than the one on screen is never
// drawn, whatever order decoding finishes in. While the viewer is elsewhere already, the newest frame is shown as it would
// look from there (reprojection.js), on a canvas over this one.

import { unpackDepth } from '../protocol/frame_depth.js';
import { poseOf } from './pose.js';
import { Reprojection } from './reprojection.js';

const mostPixels = 3840 * 2160;
const highestRatio = 2;
const settleMs = 140;
const whole = { x: 1, y: 1 };

/** Pixels of the picture for an element of that many CSS pixels: sharp, but within reason. Pure. */
export function pictureSize(width, height, ratio, limit = mostPixels) {
  const wanted = Math.min(Math.max(ratio || 1, 0.5), highestRatio);
  const most = Math.min(limit > 0 ? limit : mostPixels, mostPixels);
  const used = Math.min(wanted, Math.sqrt(most / Math.max(1, width * height)));
  return {
    width: Math.max(16, Math.floor(width * used)),
    height: Math.max(16, Math.floor(height * used)),
    ratio: used,
  };
}

export class Picture {
  #canvas;
  #context;
  #limit = 0;
  #drawnFrame = 0;
  #bitmap;
  #stretch = whole;
  #reprojection;
  #generation = 0; // of the connection: frame ids start over with each
  #onResize;
  #settle;

  /** Of the newest frame, in cells (frame_depth.js); undefined where it has none. It covers the frame's margin, too. */
  depth;

  /** From where it was drawn (pose.js), its margin included; undefined where nobody knows. */
  pose;

  /**
   * `onResize` is called when another size of picture is wanted, once the window has come to rest; `onShown` when what is seen is seen
   * from elsewhere, later than lookFrom() was called for that.
   */
  constructor(canvas, onResize, onShown = () => {}) {
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d', { alpha: true });
    this.#onResize = onResize;
    this.#reprojection = new Reprojection(canvas, onShown);
    this.#adopt();
    new ResizeObserver(() => this.#resized()).observe(canvas);
  }

  /** From where what is seen on the canvas looks, be it the frame itself or what stands in for the next one; undefined where nobody knows. */
  get shownPose() {
    return this.#reprojection.pose ?? this.pose;
  }

  /** In CSS pixels, as cursors are. */
  get cssSize() {
    return { width: Math.max(1, this.#canvas.clientWidth), height: Math.max(1, this.#canvas.clientHeight) };
  }

  get size() {
    const { width, height } = this.cssSize;
    return pictureSize(width, height, devicePixelRatio, this.#limit);
  }

  /** That a picture may have, whatever the canvas. */
  get mostPixels() {
    return this.#limit > 0 ? Math.min(this.#limit, mostPixels) : mostPixels;
  }

  setLimit(maxPixels) {
    this.#limit = maxPixels;
    this.#resized();
  }

  /** Frames of a new connection count from 1 again. */
  newStream() {
    this.#generation += 1;
    this.#drawnFrame = 0;
  }

  get isBlank() {
    return this.#bitmap === undefined;
  }

  /**
   * Decodes, where `frame.bitmap` is no promise of that, and draws; resolves to whether it was drawn. Rejects when the picture cannot be decoded.
   * @param {{ camera, bounds, stretch?: { x: number, y: number } }} [from] whence it was drawn, if that is known, and by how much
   *   it is wider and higher than what is to be seen of it
   */
  async show(frame, from) {
    const generation = this.#generation;
    // A frame whose depth is not to be had is a picture all the same.
    const unpacking = frame.packedDepth ? unpackDepth(frame.packedDepth).catch(() => undefined) : undefined;
    const bitmap = await (frame.bitmap ?? createImageBitmap(new Blob([frame.picture], { type: 'image/jpeg' })));
    const depth = await unpacking;
    if (generation !== this.#generation || frame.frameId <= this.#drawnFrame) {
      bitmap.close();
      return false;
    }
    this.#drawnFrame = frame.frameId;
    this.#bitmap?.close();
    this.#bitmap = bitmap;
    this.#stretch = from?.stretch ?? whole;
    const aspect = (bitmap.width / this.#stretch.x) / (bitmap.height / this.#stretch.y);
    this.depth = depth;
    this.pose = from && poseOf(from.camera, from.bounds, aspect, this.#stretch);
    this.#reprojection.setFrame({ bitmap, depth, pose: this.pose });
    this.#draw();
    return true;
  }

  /** Shows the newest frame as it would look from there; itself, where it is from there. */
  lookFrom(camera, bounds) {
    this.#reprojection.show(poseOf(camera, bounds, this.#canvas.width / this.#canvas.height));
  }

  /** Shows the newest frame itself; until the next one it looks like that from nowhere else, where it `isOfAnother` cloud. */
  showItself(isOfAnother = false) {
    if (isOfAnother) this.#reprojection.setFrame(undefined);
    this.#reprojection.hide();
  }

  /** Fills the canvas with the middle of the frame; one of another shape keeps its height, because the field of view is vertical. */
  #draw() {
    const { width, height } = this.#canvas;
    if (!this.#bitmap) return;
    const seen = { width: this.#bitmap.width / this.#stretch.x, height: this.#bitmap.height / this.#stretch.y };
    const scaled = (seen.width * height) / seen.height;
    const drawn = (Math.abs(scaled - width) <= 2 ? width : scaled) * this.#stretch.x;
    const drawnHeight = height * this.#stretch.y;
    this.#context.imageSmoothingQuality = 'high';
    this.#context.clearRect(0, 0, width, height);
    this.#context.drawImage(this.#bitmap, (width - drawn) / 2, (height - drawnHeight) / 2, drawn, drawnHeight);
  }

  #adopt() {
    const { width, height } = this.size;
    if (this.#canvas.width === width && this.#canvas.height === height) return false;
    this.#canvas.width = width;
    this.#canvas.height = height;
    this.#draw();
    return true;
  }

  #resized() {
    if (!this.#adopt()) return;
    clearTimeout(this.#settle);
    this.#settle = setTimeout(() => this.#onResize(this.size), settleMs);
  }
}
