// Keeps the page connected: asks for the clouds, waits while they load, opens the stream, and starts over, more and
// more patiently, whenever something breaks.

import { forgetToken, hasToken, keepToken } from './access.js';
import { fetchClouds, fetchMethods, ServerProblem } from './catalog.js';
import { Connection } from './connection.js';
import { enterAsGuest, forgetGuest, isGuest } from './guest.js';

const pollMs = 700;
const idlePollMs = 3000;

/** Milliseconds to wait before attempt number `attempt` (from 0); `random` in 0–1 keeps many pages from coming at once. */
export function backOff(attempt, random = Math.random()) {
  const full = Math.min(10_000, 500 * 2 ** Math.min(attempt, 10));
  return Math.round(full * (0.75 + 0.25 * random));
}

export class Session {
  #handlers;
  #connection;
  #timer;
  #attempt = 0;
  #nextSeq = 1;
  #resume = ''; // token of the session that was open last
  #cloud = undefined;
  #round = 0; // of two cycles that overlap, only the later one counts

  /**
   * Handlers: state({ kind, … }) with kind connecting | loading | empty | failed | locked |
   * lost | open; catalog(catalog);
   * hello() → the first message; welcome(message); frame, problem and stats as in Connection.
   */
  constructor(handlers) {
    this.#handlers = handlers;
    addEventListener('online', () => this.retryNow());
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.retryNow();
    });
  }

  get connection() {
    return this.#connection;
  }

  /** `cloud`: the id to open, if the server has it. */
  start(cloud) {
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

  /** The server asked for a token: here it is. */
  unlock(token) {
    keepToken(token);
    this.#handlers.state({ kind: 'connecting' });
    this.#cycle();
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
      if (isGuest()) await enterAsGuest();
      const { clouds, pending } = await fetchClouds();
      if (round !== this.#round) return;
      if (clouds.length === 0) {
        this.#wait(pending);
        return;
      }
      const wanted = pending.find((entry) => entry.id === this.#cloud && entry.state === 'loading');
      if (wanted) {
        this.#wait([wanted]);
        return;
      }
      const methods = await fetchMethods();
      if (round !== this.#round) return;
      this.#handlers.catalog({ clouds, pending, ...methods });
      this.#open(clouds);
    } catch (error) {
      if (round !== this.#round) return;
      if (error.status === 401) this.#locked();
      else this.#lost(error);
    }
  }

  /** Nothing to look at yet: say why, and ask again. */
  #wait(pending) {
    this.#attempt = 0;
    const loading = pending.filter((entry) => entry.state === 'loading');
    if (loading.length > 0) this.#handlers.state({ kind: 'loading', entries: loading });
    else if (pending.length > 0) this.#handlers.state({ kind: 'failed', entries: pending });
    else this.#handlers.state({ kind: 'empty' });
    this.#later(loading.length > 0 ? pollMs : idlePollMs);
  }

  #open(clouds) {
    const cloud = clouds.find((one) => one.id === this.#cloud) ?? clouds[0];
    const url = new URL('/api/v1/stream', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.#connection = new Connection(url, this.#hello(cloud), this.#nextSeq, {
      welcome: (message) => {
        this.#attempt = 0;
        this.#resume = message.resume ?? '';
        this.#cloud = message.cloud;
        this.#handlers.welcome(message);
        this.#handlers.state({ kind: 'open' });
      },
      frame: this.#handlers.frame,
      problem: this.#handlers.problem,
      stats: this.#handlers.stats,
      closed: (words) => {
        this.#nextSeq = this.#connection.nextSeq;
        this.#connection = undefined;
        this.#lost(new Error(words));
      },
    });
  }

  #hello(cloud) {
    const hello = { cloud: cloud.id, ...this.#handlers.hello() };
    return this.#resume ? { ...hello, resume: this.#resume } : hello;
  }

  /** Nothing is asked again before a token is given: trying wrong ones would help nobody. */
  #locked() {
    this.#attempt = 0;
    const [refused, guest] = [hasToken(), isGuest()];
    forgetToken();
    forgetGuest();
    this.#handlers.state({ kind: 'locked', refused, guest });
  }

  #lost(error) {
    const delay = backOff(this.#attempt);
    this.#attempt += 1;
    const words = error instanceof ServerProblem || this.#attempt === 1 ? error.message : '';
    // fetch() says "Failed to fetch" or the like, which helps nobody.
    const detail = error instanceof TypeError || error.name === 'TimeoutError' ? 'The server does not answer.' : words;
    this.#handlers.state({ kind: 'lost', detail, delay, at: performance.now() + delay });
    this.#later(delay);
  }

  /** Asks once more for the list, for clouds that finished loading meanwhile. Failures show elsewhere. */
  async refreshCatalog() {
    try {
      this.#handlers.clouds(await fetchClouds());
    } catch {
      // The stream notices a lost server by itself.
    }
  }
}
