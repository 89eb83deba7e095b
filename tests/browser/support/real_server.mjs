// `scancast serve` as a child process, to be stopped and started again at the same address. With SCANCAST_PAGE=tree in the
// environment the page is that of the working tree (page_proxy.mjs), not the one inside the program: nothing needs to be built.

import { spawn } from 'node:child_process';

import { PageProxy } from './page_proxy.mjs';

const startMs = 20_000;
const stopMs = 10_000;

export class RealServer {
  #program;
  #files;
  #flags;
  #environment;
  #child;
  #log = '';
  #proxy;
  #address;
  port = 0;

  constructor(program, files, flags = [], environment = {}) {
    this.#program = program;
    this.#files = files;
    this.#flags = flags;
    this.#environment = environment;
  }

  /** The end of what it has said on standard error. */
  get log() {
    return this.#log;
  }

  /** Returns the URL that it prints. */
  async start() {
    this.#child = spawn(this.#program, ['serve', ...this.#files, '--port', String(this.port), ...this.#flags],
      { stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, ...this.#environment } });
    this.#child.stderr.on('data', (data) => { this.#log = (this.#log + data).slice(-40_000); });
    const url = await new Promise((done, failed) => {
      const timer = setTimeout(() => failed(this.#error('said no address in time')), startMs);
      let text = '';
      this.#child.stdout.on('data', (data) => {
        text += data;
        const found = /Open (http:\S+)/.exec(text);
        if (!found) return;
        clearTimeout(timer);
        done(found[1]);
      });
      this.#child.on('error', failed);
      this.#child.on('exit', (code) => {
        clearTimeout(timer);
        failed(this.#error(`ended with ${code}`));
      });
    });
    this.port = Number(new URL(url).port);
    if (process.env.SCANCAST_PAGE !== 'tree') return url;
    if (!this.#proxy) {
      this.#proxy = new PageProxy(url);
      this.#address = await this.#proxy.start();
      this.#proxy.unref();
    }
    return this.#address;
  }

  /** Politely; `signal` SIGKILL makes it vanish. Resolves to the exit code, null after a signal. */
  async stop(signal = 'SIGTERM') {
    const child = this.#child;
    if (!child || child.exitCode !== null || child.signalCode !== null) return child?.exitCode;
    const ended = new Promise((done) => child.once('exit', done));
    child.kill(signal);
    const timer = setTimeout(() => child.kill('SIGKILL'), stopMs);
    const code = await ended;
    clearTimeout(timer);
    return code;
  }

  #error(what) {
    return new Error(`${this.#program} serve ${what}. Its log ends with:\n${this.#log}`);
  }
}
