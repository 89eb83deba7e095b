// Keeps the page connected: asks for the clouds, waits while they load, opens the stream, and starts over, more and
// more patiently, whenever something breaks. Who asked for a certain cloud is never shown another one: while it cannot be
// shown he is told why, and it comes by itself as soon as it can.

import { ServerProblem } from './server.js';
import { Connection } from './connection.js';

const pollMs = 700;
const idlePollMs = 3000;
const visibleAscii = /^[\x21-\x7e]+$/; // what a token is made of
const tooLong = 431; // a header, with the token in it

/** Milliseconds to wait before attempt number `attempt` (from 0); `random` in 0–1 keeps many pages from coming at once. */
export function backOff(attempt, random = Math.random()) {
  const full = Math.min(10_000, 500 * 2 ** Math.min(attempt, 10));
  return Math.round(full * (0.75 + 0.25 * random));
}

export class Session {
  #server;
  #handlers;
  #connection;
  #timer;
  #attempt = 0;
  #nextSeq = 1;
  #resume = ''; // token of the session that was open last
  #cloud = undefined;
  #frame = 0; // id of the newest one of that session
  #next = undefined; // the connection that is to take this one's place
  #moving = undefined; // timer, until that is tried
  #moves = 0; // that failed
  #round = 0; // of two cycles that overlap, only the later one counts

  /**
   * Handlers: state(now), where `now.kind` is
   *   connecting, open
   *   loading  `entries`, of the list, that are being read; `clouds`: those that could be looked at meanwhile
   *   failed   `entries` that could not be read, each with its `error`; `clouds` as above; `asked`: it is the one asked for
   *   gone     `cloud`: the id that was asked for, and that the server does not have; `clouds`, `pending`: what it has
   *   empty    the server has no cloud at all
   *   locked   it wants a token: `refused`, another one than it was given; `guest`: a link that is not good any more
   *   lost     `detail`: why, in words; `at`, `delay`: when it is tried again
   * catalog(catalog) and clouds(list); expect(cloud), which is shown as soon as that resolves; hello() → the first message;
   * seen(cloud, seq) → the view of that cloud that is wanted, from now on known by that number, or undefined; welcome(message); moved(message, hello), in place of it
   * where another server goes on with what is seen; frame, problem and stats as in Connection.
   */
  constructor(server, handlers) {
    this.#server = server;
    this.#handlers = handlers;
    addEventListener('online', () => this.retryNow());
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.retryNow();
    });
  }

  get connection() {
    return this.#connection;
  }

  /** `cloud`: the id to open; undefined leaves it to the server. Ends what was open before. */
  start(cloud) {
    this.#leave();
    this.#cloud = cloud;
    this.#handlers.state({ kind: 'connecting' });
    this.#cycle();
  }

  /** The cloud to come back to after a break. */
  remember(cloud) {
    this.#cloud = cloud;
  }

  retryNow() {
    if (this.#connection || this.#timer === undefined) return;
    clearTimeout(this.#timer);
    this.#cycle();
  }

  /** The server asked for a token: here it is. `remember`: on this device, and not for this tab only. */
  unlock(token, remember) {
    if (!visibleAscii.test(token.trim())) {
      this.#handlers.state({ kind: 'locked', refused: true, guest: false }); // no header could hold it
      return;
    }
    this.#server.access.keepToken(token, remember);
    this.start(this.#cloud);
  }

  /** Ends what is open, and asks for nothing any more. */
  stop() {
    this.#leave();
  }

  /** Forgets the token, here and on this device, and asks for one. */
  lock() {
    this.#leave();
    this.#server.access.forgetToken();
    this.#server.access.forgetGuest();
    this.start(this.#cloud);
  }

  /** The session that is open goes on with nobody, and nothing that is on its way counts any more. */
  #leave() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#stay();
    this.#round += 1;
    this.#attempt = 0;
    if (this.#connection) this.#nextSeq = this.#connection.nextSeq;
    this.#connection?.abandon();
    this.#connection = undefined;
    this.#resume = '';
  }

  #later(delay) {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#cycle(), delay);
  }

  async #cycle() {
    this.#timer = undefined;
    this.#round += 1;
    const round = this.#round;
    try {
      if (this.#server.access.isGuest) {
        const theirs = await this.#server.enterAsGuest();
        if (round !== this.#round) return;
        this.#cloud ??= theirs;
      }
      const list = await this.#server.clouds();
      if (round !== this.#round) return;
      const cloud = list.clouds.find((one) => one.id === (this.#cloud ?? list.clouds[0]?.id));
      if (!cloud) {
        this.#wait(list);
        return;
      }
      const [methods] = await Promise.all([this.#server.methods(), this.#handlers.expect(cloud)]);
      if (round !== this.#round) return;
      this.#handlers.catalog({ ...list, ...methods });
      this.#open(cloud);
    } catch (/** @type {any} */ error) {
      if (round !== this.#round) return;
      if (error.status === 401 || error.status === tooLong) this.#locked();
      else this.#lost(error);
    }
  }

  /** Nothing to look at yet, or not what was asked for: say why, and ask again. */
  #wait({ clouds, pending }) {
    this.#attempt = 0;
    const asked = this.#cloud !== undefined;
    const entries = asked ? pending.filter((entry) => entry.id === this.#cloud) : pending;
    const loading = entries.filter((entry) => entry.state === 'loading');
    if (loading.length > 0) this.#handlers.state({ kind: 'loading', entries: loading, clouds });
    else if (entries.length > 0) this.#handlers.state({ kind: 'failed', entries, clouds, asked });
    else if (asked) this.#handlers.state({ kind: 'gone', cloud: this.#cloud, clouds, pending });
    else this.#handlers.state({ kind: 'empty' });
    this.#later(loading.length > 0 ? pollMs : idlePollMs);
  }

  #open(cloud) {
    const hello = this.#hello(cloud.id, this.#nextSeq);
    const connection = this.#connect(hello, this.#nextSeq + (hello.view ? 1 : 0), {
      welcome: (message) => {
        this.#attempt = 0;
        this.#known(message);
        this.#cloud = message.cloud;
        this.#handlers.welcome(message);
        this.#handlers.state({ kind: 'open' });
      },
      closed: (words) => this.#closed(connection, words),
    });
    this.#connection = connection;
  }

  #connect(hello, firstSeq, handlers) {
    return new Connection(this.#server, hello, firstSeq, {
      frame: (frame) => {
        this.#frame = frame.frameId;
        this.#handlers.frame(frame);
      },
      problem: this.#handlers.problem,
      stats: this.#handlers.stats,
      drain: (message) => this.#leaveIn(message.afterMilliseconds ?? 0),
      ...handlers,
    });
  }

  #known({ resume, resumed }) {
    this.#resume = resume ?? '';
    if (!resumed) this.#frame = 0;
  }

  /** With what another server needs, which has never heard of the session. */
  #hello(cloud, seq) {
    const hello = { cloud, ...this.#handlers.hello() };
    if (!this.#resume) return hello;
    const view = this.#handlers.seen(cloud, seq);
    return { ...hello, resume: this.#resume, ...(view && { view, seq, frame: this.#frame }) };
  }

  #closed(connection, words) {
    if (connection !== this.#connection) return;
    this.#nextSeq = connection.nextSeq;
    this.#connection = undefined;
    if (this.#next) return; // which takes over, or cannot
    this.#stay();
    this.#lost(new Error(words));
  }

  // A server that will be gone: another one at its address takes over, and until it has this one draws.

  #leaveIn(delay) {
    clearTimeout(this.#moving);
    this.#moving = setTimeout(() => this.#move(), delay);
  }

  #stay() {
    clearTimeout(this.#moving);
    this.#next?.abandon();
    this.#next = undefined;
    this.#moves = 0;
  }

  /** Connects anew with another hello, and goes on with what is seen. */
  renew() {
    this.#leaveIn(0);
  }

  #move() {
    const from = this.#connection;
    if (!from || this.#next) return;
    const next = this.#connect(this.#hello(this.#cloud, from.takeSeq()), from.nextSeq, {
      welcome: (message) => {
        next.follow(from);
        this.#next = undefined;
        this.#stay();
        from.abandon();
        this.#connection = next;
        this.#known(message);
        this.#handlers.moved(message, next.hello);
      },
      closed: (words) => {
        if (next !== this.#next) {
          this.#closed(next, words);
          return;
        }
        this.#next = undefined;
        if (this.#connection) this.#leaveIn(backOff(this.#moves));
        else this.#lost(new Error(words));
        this.#moves += 1;
      },
    });
    this.#next = next;
  }

  /** Nothing is asked again before a token is given: trying wrong ones would help nobody. */
  #locked() {
    this.#attempt = 0;
    const [refused, guest] = [this.#server.access.hasToken, this.#server.access.isGuest];
    this.#server.access.forgetToken({ onDevice: !guest }); // it was the guest's pass that was refused
    this.#server.access.forgetGuest();
    if (guest && this.#server.access.hasToken) {
      this.#cycle();
      return;
    }
    this.#handlers.state({ kind: 'locked', refused, guest });
  }

  #lost(error) {
    const delay = backOff(this.#attempt);
    this.#attempt += 1;
    const words = error instanceof ServerProblem || this.#attempt === 1 ? error.message : '';
    // fetch() says "Failed to fetch" or the like, which helps nobody.
    const detail = error instanceof TypeError || error.name === 'TimeoutError' ? 'The server is not responding.' : words;
    this.#handlers.state({ kind: 'lost', detail, delay, at: performance.now() + delay });
    this.#later(delay);
  }

  /** Asks once more for the list, for clouds that finished loading meanwhile. Failures show elsewhere. */
  async refreshCatalog() {
    try {
      this.#handlers.clouds(await this.#server.clouds());
    } catch {
      // The stream notices a lost server by itself.
    }
  }
}
