// `scancast-ranks front` as a child, for tests and measurements: its ranks by their numbers, its metrics, its log.

import { spawn, spawnSync } from 'node:child_process';
import { closeSync, mkdtempSync, openSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export const sleep = (ms) => new Promise((done) => { setTimeout(done, ms); });
const patienceMs = 60_000;

/** Resolves when `holds` does, with what it says. */
export async function until(what, holds) {
  for (const end = Date.now() + patienceMs; ;) {
    const held = await holds();
    if (held) return held;
    if (Date.now() > end) throw new Error(`${what} took more than ${patienceMs / 1000} s`);
    await sleep(20);
  }
}

/** As many ranks as asked for, whatever there is; not as one who may not. */
export const mpirun = (count) =>
  `mpirun ${process.getuid() === 0 ? '--allow-run-as-root ' : ''}--quiet --oversubscribe --bind-to none -n ${count}`;

/** Whether mpirun can be started here. */
export const hasMpirun = () => spawnSync('mpirun', ['--version']).status === 0;

/** Processes that any thread of this one has started. */
function childrenOf(pid) {
  try {
    return readdirSync(`/proc/${pid}/task`).flatMap((thread) =>
      readFileSync(`/proc/${pid}/task/${thread}/children`, 'utf8').split(' ').filter(Boolean).map(Number));
  } catch {
    return []; // it has just ended
  }
}

function environmentOf(pid) {
  try {
    return readFileSync(`/proc/${pid}/environ`, 'utf8').split('\0');
  } catch {
    return [];
  }
}

/** What runs and is no zombie. */
export function isRunning(pid) {
  try {
    return !/^State:\s+[ZX]/m.test(readFileSync(`/proc/${pid}/status`, 'utf8'));
  } catch {
    return false;
  }
}

/** A server of any kind: `words` are the program and what follows it but the port. */
export class Server {
  #folder = mkdtempSync(join(tmpdir(), 'scancast-front-'));
  url = '';
  cloud = '';

  async start(words) {
    const log = openSync(this.#logFile(), 'a');
    this.child = spawn(words[0], [...words.slice(1), '--port', '0'], { stdio: ['ignore', 'pipe', log] });
    closeSync(log);
    this.ended = new Promise((done) => { this.child.on('exit', (code, signal) => done({ code, signal })); });
    let said = '';
    this.child.stdout.on('data', (text) => { said += text; });
    let over;
    this.ended.then((how) => { over = how; });
    const running = (held) => {
      if (over) throw new Error(`it ended with ${over.code ?? over.signal}: ${this.log().slice(-2000)}`);
      return held;
    };
    this.url = await until('the address', () => running(said.match(/http:\S+/)?.[0]));
    await until('the server', async () => running((await fetch(`${this.url}readyz`)).status === 200));
    this.cloud = await until('the cloud', async () => {
      const clouds = await (await fetch(`${this.url}api/v1/clouds`)).json();
      return running(!clouds.pending?.length && clouds.clouds[0]?.id);
    });
    return this;
  }

  log() {
    return readFileSync(this.#logFile(), 'utf8');
  }

  #logFile() {
    return join(this.#folder, 'log');
  }

  /** Status and bytes. */
  async get(path, options = {}) {
    const answer = await fetch(`${this.url}api/v1/clouds/${this.cloud}/${path}`, options);
    return { status: answer.status, bytes: Buffer.from(await answer.arrayBuffer()) };
  }

  async metric(name) {
    const text = await (await fetch(`${this.url}metrics`)).text();
    return Number(text.match(new RegExp(`^${name} (\\S+)`, 'm'))?.[1]);
  }

  async stop(signal = 'SIGTERM') {
    this.child?.kill(signal); // that it has ended already is no fault
    const how = await this.ended;
    rmSync(this.#folder, { recursive: true, force: true });
    return how;
  }
}

export class Front extends Server {
  /** `flags`: of the front; `count` ranks of one thread each. */
  start(program, flags, count) {
    return super.start([program, 'front', ...flags, '--start', mpirun(count), '--ranks-threads', '1', '--ranks-memory', '128M']);
  }

  mpirun() {
    return childrenOf(this.child.pid).find((pid) => environmentOf(pid).length > 0);
  }

  /** Process ids by rank; those that are there. */
  ranks() {
    const found = [];
    for (const pid of childrenOf(this.mpirun() ?? 0)) {
      const rank = environmentOf(pid).find((word) => word.startsWith('OMPI_COMM_WORLD_RANK='));
      if (rank) found[Number(rank.split('=')[1])] = pid;
    }
    return found;
  }

  /** Resolves when ranks draw, after `restarts` starts beyond the first. */
  async untilUp(restarts = 0) {
    await until('the ranks', async () =>
      await this.metric('scancast_ranks_restarts_total') >= restarts && await this.metric('scancast_ranks_up') === 1);
  }
}
