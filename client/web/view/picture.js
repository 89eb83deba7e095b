// The canvas: sizes it, and draws frames on it in their order. A frame that is older than the one on screen is never
// drawn, whatever order decoding finishes in.

const mostPixels = 3840 * 2160;
const highestRatio = 2;
const settleMs = 140;

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
  #generation = 0; // of the connection: frame ids start over with each
  #onResize;
  #settle;

  /** `onResize` is called when another size of picture is wanted, once the window has come to rest. */
  constructor(canvas, onResize) {
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d', { alpha: true });
    this.#onResize = onResize;
    this.#adopt();
    new ResizeObserver(() => this.#resized()).observe(canvas);
  }

  /** In CSS pixels, as cursors are. */
  get cssSize() {
    return { width: Math.max(1, this.#canvas.clientWidth), height: Math.max(1, this.#canvas.clientHeight) };
  }

  get size() {
    const { width, height } = this.cssSize;
    return pictureSize(width, height, devicePixelRatio, this.#limit);
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

  /** Decodes and draws; resolves to whether it was drawn. Rejects when the picture cannot be decoded. */
  async show(frame) {
    const generation = this.#generation;
    const bitmap = await createImageBitmap(new Blob([frame.picture], { type: 'image/jpeg' }));
    if (generation !== this.#generation || frame.frameId <= this.#drawnFrame) {
      bitmap.close();
      return false;
    }
    this.#drawnFrame = frame.frameId;
    this.#bitmap?.close();
    this.#bitmap = bitmap;
    this.#draw();
    return true;
  }

  /** Fills the canvas; a picture of another shape keeps its height, because the field of view is vertical. */
  #draw() {
    const { width, height } = this.#canvas;
    if (!this.#bitmap) return;
    const scaled = (this.#bitmap.width * height) / this.#bitmap.height;
    const drawn = Math.abs(scaled - width) <= 2 ? width : scaled;
    this.#context.imageSmoothingQuality = 'high';
    this.#context.clearRect(0, 0, width, height);
    this.#context.drawImage(this.#bitmap, (width - drawn) / 2, 0, drawn, height);
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
