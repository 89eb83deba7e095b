// While a newer frame is on its way, the last one as it would look from where the viewer is by now: drawn anew on the mesh
// of its depth, on a canvas of its own that lies over the picture. It is seen only while the picture is of another view;
// what the picture's canvas shows is never touched.
//
// Without depth it is the plane through what was looked at; without WebGL 2 the picture is shifted and scaled.

import { ReprojectionProgram } from './reprojection_program.js';
import { backdropScale, placeToClip, seesTheSame, similarityOf } from './pose.js';

const patience = 10; // slow ones in a row
/** Share of the picture's pixels in each direction, and what more milliseconds than these are for it: too slow. */
const levels = [{ share: 1, slowMs: 25 }, { share: 0.5, slowMs: 50 }];
const fastMs = 8;
const pauseMs = 10_000; // after which it is tried again where even the last one was too slow

/** Put into the document by `canvas`, whose place and size it takes. */
function canvasOver(canvas) {
  const over = document.createElement('canvas');
  over.setAttribute('aria-hidden', 'true');
  over.className = 'reprojection';
  Object.assign(over.style, { position: 'absolute', pointerEvents: 'none', visibility: 'hidden' });
  canvas.after(over);
  return over;
}

export class Reprojection {
  #canvas;
  #over;
  /** @type {WebGL2RenderingContext | undefined} where there is one and it is not lost */
  #gl;
  #program;
  #context; // 2d, where there is no WebGL
  #frame; // { bitmap, depth, pose }
  #isLoaded = false; // whether the program has this frame
  #slow = 0;
  #level = 0;
  #pausedUntil = -Infinity;
  #fast = 0; // the same of fast ones
  #pending; // { fence, start } of one that the graphics processor has not finished
  #owed; // from where to show it as soon as that is finished
  #pose; // from where the one that is seen looks
  #late; // told of one that was owed

  /** What the newest one took, in milliseconds, from its first command to its last pixel; undefined before any has been measured. */
  milliseconds;

  /** Over that canvas, which is in the document. `late()` hears of one that is seen later than show() was called for it. */
  constructor(canvas, late = () => {}) {
    this.#canvas = canvas;
    this.#late = late;
    this.#over = canvasOver(canvas);
    const options = { alpha: true, antialias: false, depth: true, stencil: false, powerPreference: 'high-performance' };
    this.#gl = /** @type {WebGL2RenderingContext} */ (this.#over.getContext('webgl2', options)) ?? undefined;
    if (!this.#gl) {
      this.#context = this.#over.getContext('2d');
      return;
    }
    const gl = this.#gl;
    this.#program = ReprojectionProgram.create(gl);
    this.#over.addEventListener('webglcontextlost', (event) => {
      event.preventDefault(); // so that it comes back
      this.#gl = this.#program = this.#pending = undefined;
      this.#isLoaded = false;
      this.hide();
    });
    this.#over.addEventListener('webglcontextrestored', () => {
      this.#gl = gl;
      this.#program = ReprojectionProgram.create(gl);
    });
  }

  /** The frame on the picture's canvas, which stays its owner's. `depth` may be missing, and `pose` where nobody knows it. */
  setFrame(frame) {
    this.#frame = frame;
    this.#isLoaded = false;
  }

  hide() {
    this.#owed = undefined;
    this.#over.style.visibility = 'hidden';
  }

  get isVisible() {
    return this.#over.style.visibility === 'visible';
  }

  /** From where the one that is seen looks (pose.js); undefined while the picture itself is seen. */
  get pose() {
    return this.isVisible ? this.#pose : undefined;
  }

  /** The frame as it would look from there; nothing where it is from there. */
  show(wanted) {
    const frame = this.#frame;
    if (!frame?.pose || performance.now() < this.#pausedUntil || seesTheSame(frame.pose, wanted)) {
      this.hide();
      return;
    }
    this.#owed = undefined;
    if (this.#program && !this.#isFinished()) {
      this.#owed = wanted; // no queue of old pictures
      return;
    }
    const drawn = this.#context ? this.#scale(frame, wanted) : this.#warp(frame, wanted);
    if (!drawn) {
      this.hide();
      return;
    }
    this.#align();
    this.#pose = wanted;
    this.#over.style.visibility = 'visible';
  }

  /** On the very rectangle of the picture: panels come and go beside it. */
  #align() {
    const isFixed = getComputedStyle(this.#canvas).position === 'fixed';
    const { offsetLeft, offsetTop, clientWidth, clientHeight } = this.#canvas;
    const place = { position: isFixed ? 'fixed' : 'absolute', left: `${offsetLeft}px`, top: `${offsetTop}px`, width: `${clientWidth}px`, height: `${clientHeight}px` };
    for (const [key, value] of Object.entries(place)) {
      if (this.#over.style[key] !== value) this.#over.style[key] = value;
    }
  }

  #adoptSize() {
    const { share } = levels[this.#level];
    const width = Math.ceil(this.#canvas.width * share);
    const height = Math.ceil(this.#canvas.height * share);
    if (this.#over.width === width && this.#over.height === height) return;
    this.#over.width = width;
    this.#over.height = height;
  }

  #warp(frame, wanted) {
    if (!this.#program) return false;
    const start = performance.now();
    this.#adoptSize();
    if (!this.#isLoaded) this.#program.load(frame);
    this.#isLoaded = true;
    this.#program.draw(placeToClip(frame.pose, wanted, this.#program.depths), backdropScale(frame.pose, wanted));
    this.#pending = { start, fence: this.#gl.fenceSync(this.#gl.SYNC_GPU_COMMANDS_COMPLETE, 0) };
    this.#gl.flush();
    setTimeout(() => this.#await());
    return true;
  }

  /** Whether the graphics processor has nothing left to do; takes note of how long the last one took. */
  #isFinished() {
    const gl = this.#gl;
    const { fence, start } = this.#pending ?? {};
    if (!fence) return true;
    if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(fence);
    this.#pending = undefined;
    this.milliseconds = performance.now() - start;
    this.#judge();
    return true;
  }

  #await() {
    if (!this.#isFinished()) setTimeout(() => this.#await(), 2);
    else if (this.#owed) {
      this.show(this.#owed);
      this.#late();
    }
  }

  /** Who is too slow draws coarser ones, then none for a while; who has been fast for long, finer ones. */
  #judge() {
    this.#slow = this.milliseconds > levels[this.#level].slowMs ? this.#slow + 1 : 0;
    this.#fast = this.milliseconds < fastMs ? this.#fast + 1 : 0;
    if (this.#fast > 10 * patience) {
      this.#fast = 0;
      this.#level = Math.max(0, this.#level - 1);
    }
    if (this.#slow < patience) return;
    this.#slow = 0;
    if (this.#level + 1 < levels.length) {
      this.#level += 1;
    } else {
      this.#pausedUntil = performance.now() + pauseMs;
      this.hide();
    }
  }

  /** The picture stays below, so that what moves away leaves no hole. */
  #scale({ bitmap, pose }, wanted) {
    const fit = similarityOf(pose, wanted);
    if (!fit || !this.#context) return false;
    this.#adoptSize();
    const { width, height } = this.#over;
    const drawnHeight = height * fit.scale * wanted.stretch;
    const drawnWidth = drawnHeight * pose.aspect;
    const [x, y] = [(width * (1 + fit.x)) / 2, (height * (1 - fit.y)) / 2];
    this.#context.clearRect(0, 0, width, height);
    this.#context.drawImage(bitmap, x - drawnWidth / 2, y - drawnHeight / 2, drawnWidth, drawnHeight);
    return true;
  }
}
