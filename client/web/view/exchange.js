// What goes out and what comes back: the view that is wanted, said once and as a whole, and the pictures of it, with what they
// show of the surface. Knows from where each picture was drawn. Who moves the camera, and why, is the viewer's (viewer.js).

import { withMargin } from './margin.js';
import { remembering, seenFrom } from './seen.js';
import { ViewState } from './view_state.js';

export class Exchange {
  #canvas;
  #picture;
  #state = new ViewState();
  #said; // { seq, camera } of the view that the newest hello says
  #asked = new Map(); // seq → { camera, stretch }, of views whose pictures may still come; stretch where they have a margin
  #onScreen; // { camera, stretch } of the picture on the canvas
  #firstWanted = 0; // frames of earlier views are not what the user asked for
  #hasMargins = true; // as long as the server draws them

  /** askable(view): what of it can be asked for by now; it is wanted all the same. */
  askable = (view) => view;

  /** What the latest pictures have seen of the surface (seen.js), the newest first. */
  seen = [];

  /** `canvas.dataset` tells which view was asked for last (`asked`) and which is shown (`shown`, `frame`). */
  constructor(canvas, picture) {
    this.#canvas = canvas;
    this.#picture = picture;
  }

  /** All that is asked for, as the protocol has it. */
  get wanted() { return this.#state.wanted; }

  get hasNews() { return this.#state.hasNews(this.askable(this.wanted)); }

  /** Whether the picture of view number `seq` is one of what is shown now, and not of an earlier cloud. */
  isOfThis(seq) { return seq >= this.#firstWanted; }

  change(changes) {
    this.#state.change(changes);
  }

  /** Another cloud, or another connection: all is said anew, from view number `nextSeq` on. */
  begin(view, nextSeq) {
    this.#state.begin(view);
    this.#firstWanted = nextSeq;
    this.#asked.clear();
    this.#onScreen = undefined;
    delete this.#canvas.dataset.shown; // what is on the canvas is nothing of this
    this.#hasMargins = true;
    this.seen = [];
    this.#picture.showItself(true);
  }

  /**
   * Says what is wanted, where the server does not know it yet; around it, while the camera moves, what may come into view next.
   * Returns the number of the view, or undefined where there was nothing to say.
   */
  send(connection, camera, isMoving) {
    // While the line is full, requests overwrite each other here: the next tick sends the newest.
    if (connection.congested) return undefined;
    const asked = this.askable(this.wanted);
    const larger = isMoving && this.#hasMargins ? withMargin(asked, this.#picture.mostPixels) : undefined;
    const changes = this.#state.take(connection.nextSeq, larger?.view ?? asked);
    if (!changes) return undefined;
    const seq = connection.sendView(changes);
    this.#asked.set(seq, { camera, stretch: larger?.stretch });
    this.#canvas.dataset.asked = String(seq);
    return seq;
  }

  /** What is wanted, as a hello says it, which gives it that number. */
  say(seq, camera) {
    const { cloud, ...view } = this.askable(this.wanted);
    this.#said = { seq, camera };
    this.#asked.set(seq, { camera });
    return view;
  }

  /**
   * Another server goes on, of which that hello was asked; what is said to it next has the number `nextSeq`. It begins with what the
   * hello said, and the one before has shown newer views meanwhile: where something else is wanted by now, all of it is said, and
   * nothing older comes onto the canvas again.
   */
  moved({ view, seq, cloud }, nextSeq) {
    if (view) this.#state.said(seq, { cloud, ...view });
    if (!view || this.hasNews) {
      this.#state.resend();
      this.#firstWanted = nextSeq;
      return;
    }
    // Frames of later numbers may have made it forgotten.
    if (this.#said?.seq === seq) this.#asked.set(seq, { camera: this.#said.camera });
    this.#canvas.dataset.asked = String(seq);
  }

  /**
   * Draws a frame that has come. Resolves to undefined where it is not to be seen (any more), else to { exact }: whether it shows the
   * view itself, and no more around it. Rejects where it cannot be decoded.
   */
  async show(frame, bounds) {
    const { camera, stretch } = this.#asked.get(frame.seq) ?? this.#onScreen ?? {};
    const from = camera && { camera, bounds, stretch };
    if (!this.isOfThis(frame.seq)) frame.bitmap?.then((decoded) => decoded.close(), () => {});
    if (!this.isOfThis(frame.seq) || !(await this.#picture.show(frame, from))) return undefined;
    this.#state.shown(frame.seq);
    this.#onScreen = { camera, stretch };
    const { depth, pose } = this.#picture;
    if (depth && pose) this.seen = remembering(this.seen, seenFrom(camera, depth, pose));
    for (const seq of this.#asked.keys()) {
      if (seq < frame.seq) this.#asked.delete(seq);
    }
    this.#canvas.dataset.shown = String(frame.seq);
    this.#canvas.dataset.frame = String(frame.frameId);
    return { exact: !stretch };
  }

  /** View number `seq` was refused; it may be the margin that is too much, and nobody but this page asked for that. */
  refusedMargin(seq) {
    if (!this.#asked.get(seq)?.stretch) return false;
    this.#hasMargins = false;
    this.#state.resend();
    return true;
  }

  /** Takes back what was refused; true where another view is wanted now. `sound` is what surely works. */
  refused(seq, sound) {
    return this.#state.refused(seq, sound);
  }
}
