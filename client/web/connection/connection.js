// One WebSocket to the stream, subprotocol scancast.v1: messages out, messages and frames in. It lives from open to
// close; session.js makes a new one when it is lost.

import { FrameError, parseFrame } from '../protocol/frame_header.js';

const welcomePatienceMs = 10_000;
const pingEveryMs = 15_000;
const congestedBytes = 16 * 1024;
const done = 1000; // close code: see protocol/PROTOCOL.md

/** Why a connection ended, for people. */
export function closeWords(code, reason) {
  const words = {
    1001: 'The server is shutting down.',
    1002: 'The server has been updated. Reload this page.',
    1008: 'The server does not allow this connection.',
    1013: 'The server is full: all its connections are taken.',
  };
  return reason || words[code] || 'The server is not responding.';
}

/** A view in the size that the server likes. */
function sizeless({ width, height, ...view }) {
  return view;
}

export class Connection {
  #socket;
  #handlers;
  #timers = [];
  #lastSeq;
  #heard = 0;
  #bye = '';
  #closed = false;
  #welcomed = false;
  #hello;

  /**
   * `hello` is the first message; `firstSeq` the number that the first view gets. Handlers: welcome(message),
   * frame(frame), problem(message), stats(message), drain(message), closed(words), the last one exactly once.
   */
  constructor(server, hello, firstSeq, handlers) {
    this.#handlers = handlers;
    this.#hello = hello;
    this.#lastSeq = firstSeq - 1;
    this.#socket = new WebSocket(server.streamUrl, server.access.subprotocols);
    this.#socket.binaryType = 'arraybuffer';
    this.#socket.onopen = () => this.#send({ type: 'hello', ...hello });
    this.#socket.onmessage = (event) => this.#received(event.data);
    this.#socket.onclose = (event) => this.#end(closeWords(event.code, event.reason || this.#bye));
    this.#timers.push(setTimeout(() => this.#end('The server is not responding.'), welcomePatienceMs));
  }

  get nextSeq() {
    return this.#lastSeq + 1;
  }

  /** What it began with, without what the server refused. */
  get hello() {
    return this.#hello;
  }

  /** A number for a view that is said elsewhere. */
  takeSeq() {
    this.#lastSeq += 1;
    return this.#lastSeq;
  }

  /** It goes on where that one stops. */
  follow(other) {
    this.#lastSeq = Math.max(this.#lastSeq, other.nextSeq - 1);
  }

  /** What was sent is still on its way out: better wait and send something newer. */
  get congested() {
    return this.#socket.bufferedAmount > congestedBytes;
  }

  sendView(changes) {
    this.#lastSeq += 1;
    this.#send({ type: 'view', seq: this.#lastSeq, ...changes });
    return this.#lastSeq;
  }

  acknowledge(frame) {
    this.#send({ type: 'ack', frame });
  }

  /** Ends it without a word to the handlers; the server need not keep the session for anybody who comes back. */
  abandon() {
    this.#handlers = undefined;
    this.#end('', done);
  }

  #send(message) {
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  #received(data) {
    this.#heard = performance.now();
    if (typeof data === 'string') this.#text(data);
    else this.#frame(data);
  }

  #frame(data) {
    try {
      this.#handlers?.frame(parseFrame(data));
    } catch (error) {
      if (!(error instanceof FrameError)) throw error;
      this.#end(`The server sent something that this page cannot read: ${error.message}.`);
    }
  }

  #text(data) {
    let message;
    try {
      message = JSON.parse(data);
    } catch {
      this.#end('The server sent something that this page cannot read.');
      return;
    }
    if (message.type === 'welcome') {
      this.#welcomed = true;
      this.#stopTimers();
      this.#timers.push(setInterval(() => this.#checkPulse(), pingEveryMs));
      this.#handlers?.welcome(message);
    } else if (message.type === 'problem') {
      if (this.#welcomed) this.#handlers?.problem(message);
      else this.#refusedAtTheDoor(message.problem);
    } else if (message.type === 'stats') {
      this.#handlers?.stats(message);
    } else if (message.type === 'drain') {
      this.#handlers?.drain(message);
    } else if (message.type === 'bye') {
      this.#bye = closeWords(message.code, message.reason);
    }
  }

  /**
   * The size may be more than this server draws, and only its welcome says how much that is: ask for less, once. And older
   * servers refuse words that they do not know.
   */
  #refusedAtTheDoor(problem) {
    const refused = problem?.errors?.map(({ parameter }) => parameter) ?? [];
    const { codecs, ...elder } = this.#hello;
    const { width, height, depth, ...rest } = this.#hello;
    const { view, seq, frame, ...unseen } = this.#hello;
    // Words of the view are named like "camera.eye": one that cannot be shown any more is not shown at once.
    if (codecs && refused.includes('codecs')) this.#hello = elder;
    else if (depth !== undefined && refused.includes('depth')) this.#hello = { ...rest, width, height };
    else if (problem?.status === 413 && width !== undefined) this.#hello = { ...rest, depth, ...(view && { view: sizeless(view) }) };
    else if (view !== undefined && problem?.status < 500 && problem?.status !== 404) this.#hello = unseen;
    else {
      this.#end(problem?.detail || 'The server refused the connection.');
      return;
    }
    this.#send({ type: 'hello', ...this.#hello });
  }

  /** A cable that was pulled closes nothing: ask, and give up when two questions stay unanswered. */
  #checkPulse() {
    if (performance.now() - this.#heard > 2.5 * pingEveryMs) this.#end('The server has stopped responding.');
    else this.#send({ type: 'ping', id: Math.round(performance.now()) });
  }

  #stopTimers() {
    // clearTimeout and clearInterval take either kind.
    this.#timers.splice(0).forEach(clearTimeout);
  }

  #end(words, code = undefined) {
    if (this.#closed) return;
    this.#closed = true;
    this.#stopTimers();
    this.#socket.close(code);
    this.#handlers?.closed(words);
    this.#handlers = undefined;
  }
}
