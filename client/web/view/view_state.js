// What the user wants to see, what the server has been told of it, and what it has been seen to accept. Plain logic
// without a socket or a document.
//
// A `view` message carries only what differs from the last one sent. The server refuses a message as a whole, so a
// refusal takes the request back to what was last accepted and says everything once more.

const equal = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** The fields of `wanted` that differ from `sent`. A new method drops the old one's parameters, so it takes its own along. */
export function difference(sent, wanted) {
  const changes = {};
  for (const [key, value] of Object.entries(wanted)) {
    if (!equal(sent[key], value)) changes[key] = value;
  }
  if ('method' in changes && 'param' in wanted) changes.param = wanted.param;
  // Parameters that are gone must be said to be gone.
  if (!('method' in changes) && 'param' in changes) {
    const gone = Object.keys(sent.param ?? {}).filter((name) => !(name in wanted.param));
    changes.param = { ...wanted.param, ...Object.fromEntries(gone.map((name) => [name, null])) };
  }
  return changes;
}

export class ViewState {
  wanted = {};
  #sent = {};
  #accepted = undefined;
  #waiting = new Map(); // seq → the whole request that it stood for

  /** Starts over, with another cloud or a new connection: the next message says everything. */
  begin(view) {
    this.wanted = { ...view };
    this.#accepted = undefined;
    this.resend();
  }

  resend() {
    this.#sent = {};
    this.#waiting.clear();
  }

  /** The server has been told exactly that, by message number `seq`. */
  said(seq, view) {
    this.resend();
    this.#sent = view;
    this.#waiting.set(seq, view);
  }

  change(changes) {
    this.wanted = { ...this.wanted, ...changes };
  }

  /**
   * What to send now, or undefined when the server knows it all; `seq` is the number of the message it goes into. `asked`: what
   * stands for what is wanted, such as the same with a margin.
   */
  take(seq, asked = this.wanted) {
    const changes = difference(this.#sent, asked);
    if (Object.keys(changes).length === 0) return undefined;
    this.#sent = asked;
    this.#waiting.set(seq, this.wanted);
    return changes;
  }

  hasNews(asked = this.wanted) {
    return Object.keys(difference(this.#sent, asked)).length > 0;
  }

  /** A frame of that view came: it and everything before it has been accepted. */
  shown(seq) {
    for (const [waiting, view] of this.#waiting) {
      if (waiting > seq) break;
      this.#accepted = view;
      this.#waiting.delete(waiting);
    }
  }

  /**
   * The message was refused. Takes back what it changed and returns true when the request is another one now; `fallback`
   * is what surely works, for when nothing has been accepted yet.
   */
  refused(seq, fallback) {
    const refused = this.#waiting.get(seq);
    if (!refused) return false;
    const sound = this.#accepted ?? fallback;
    const reverted = { ...this.wanted };
    for (const key of Object.keys(refused)) {
      // Only what is still as it was refused: the user may have gone on meanwhile.
      if (!equal(refused[key], sound[key]) && equal(reverted[key], refused[key])) reverted[key] = sound[key];
    }
    const changed = !equal(reverted, this.wanted);
    this.wanted = reverted;
    this.#waiting.clear();
    // Once more from the start; but the same request again would only be refused again.
    this.#sent = changed ? {} : this.wanted;
    return changed;
  }
}
