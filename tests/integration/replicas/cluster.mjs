// Several `scancast serve` with the same clouds behind a real nginx, configured by the files of deploy/nginx: what a test, or a
// measurement, stops, kills and starts again. Everything lies in a temporary folder and listens on this machine alone.

import { spawn, spawnSync } from 'node:child_process';
import { randomBytes } from 'node:crypto';
import { existsSync, mkdirSync, mkdtempSync, openSync, closeSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../../..');
const patienceMs = 60_000;

/** Where nginx is, or nothing. */
export function nginxProgram() {
  return [...(process.env.PATH ?? '').split(':'), '/usr/sbin'].map((folder) => join(folder, 'nginx')).find((path) => existsSync(path));
}

export const sleep = (ms) => new Promise((done) => { setTimeout(done, ms); });

/** A port that nobody listens on now. */
function freePort() {
  return new Promise((done, failed) => {
    const probe = createServer().on('error', failed).listen(0, '127.0.0.1', () => {
      const { port } = probe.address();
      probe.close(() => done(port));
    });
  });
}

async function until(what, holds) {
  for (const end = Date.now() + patienceMs; ;) {
    if (await holds()) return;
    if (Date.now() > end) throw new Error(`${what} took more than ${patienceMs / 1000} s`);
    await sleep(20);
  }
}

const statusOf = async (url) => {
  try {
    const answer = await fetch(url);
    await answer.arrayBuffer();
    return answer.status;
  } catch {
    return 0;
  }
};

/** Replaces what stands in a text once. */
function replaced(text, from, to) {
  const parts = text.split(from);
  if (parts.length !== 2) throw new Error(`"${from}" stands ${parts.length - 1} times in the file, not once`);
  return parts.join(to);
}

/** One server; its port and its log stay when it is started again. */
class Replica {
  #child;

  constructor(program, flags, port, log) {
    this.program = program;
    this.flags = flags;
    this.port = port;
    this.log = log;
    this.url = `http://127.0.0.1:${port}/`;
  }

  async start() {
    const log = openSync(this.log, 'a');
    this.#child = spawn(this.program, ['serve', '--port', String(this.port), ...this.flags], { stdio: ['ignore', log, log] });
    closeSync(log);
    const child = this.#child;
    this.ended = new Promise((done) => { child.on('exit', (code, signal) => done({ code, signal })); });
    let over;
    this.ended.then((how) => { over = how; });
    await until(`the start of the replica at port ${this.port}`, async () => {
      if (over) throw new Error(`the replica ended with ${over.code ?? over.signal}: ${readFileSync(this.log, 'utf8').slice(-2000)}`);
      return await statusOf(`${this.url}readyz`) === 200;
    });
  }

  /** Sends the signal and resolves when the process has ended: `{ code, signal }`. */
  async stop(signal = 'SIGTERM') {
    this.#child.kill(signal);
    return this.ended;
  }
}

export class Cluster {
  #folder = mkdtempSync(join(tmpdir(), 'scancast-replicas-'));
  #nginx;
  replicas = [];
  url = '';

  /**
   * Starts `count` replicas that serve `clouds` (cloud files; `flags` go to each), and nginx before them.
   */
  async start(program, clouds, { count = 3, flags = [], drainSeconds = 10 } = {}) {
    const catalog = join(this.#folder, 'clouds');
    mkdirSync(catalog);
    for (const cloud of clouds) symlinkSync(resolve(cloud), join(catalog, basename(cloud)));
    const key = join(this.#folder, 'session-key');
    writeFileSync(key, `sessions ${randomBytes(32).toString('base64')}\n`, { mode: 0o600 });
    for (let i = 0; i < count; ++i) {
      this.replicas.push(new Replica(program, ['--catalog', catalog, '--session-key-file', key, '--drain-seconds', String(drainSeconds),
        '--trusted-proxy', '127.0.0.1', ...flags], await freePort(), join(this.#folder, `replica-${i}.log`)));
    }
    await Promise.all(this.replicas.map((replica) => replica.start()));
    await this.#startNginx(count);
  }

  async #startNginx(count) {
    const port = await freePort();
    const text = (name) => readFileSync(join(root, 'deploy/nginx', name), 'utf8');
    let site = text('scancast.conf').replace(/upstream scancast \{[^}]*\}\n/, '').replace(/^server \{\n {4}listen 80;[^}]*\}\n/m, '');
    site = site.replace(/listen 443 ssl http2;/, `listen 127.0.0.1:${port};`).replace(/^ *ssl_.*\n/gm, '').replace(/server_name .*/, 'server_name localhost;');
    site = replaced(site, '# include /etc/nginx/scancast-replicas-server.conf;', `include ${join(root, 'deploy/nginx/replicas-server.conf')};`);
    // All clients of a test come from one address, and many come at once.
    site = site.replace(/limit_(req|conn) .*\n/g, '');
    let number = 0;
    const upstream = text('replicas.conf').replace(/^( {4}server )10\.0\.0\.\d+:8080/gm, (_, before) => `${before}127.0.0.1:${this.replicas[number++]?.port}`);
    if (number !== count) throw new Error(`replicas.conf has ${number} replicas, not ${count}`);
    const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((kind) => `${kind}_temp_path ${this.#folder}/${kind};`).join('\n');
    const file = join(this.#folder, 'nginx.conf');
    writeFileSync(file, `daemon off;\nmaster_process off;\npid ${this.#folder}/pid;\nerror_log ${this.#folder}/nginx.log;\n`
      + `events { worker_connections 4096; }\nhttp {\naccess_log off;\n${temporary}\n${upstream}\n${site}\n}\n`);
    const checked = spawnSync(nginxProgram(), ['-t', '-c', file, '-p', this.#folder], { encoding: 'utf8' });
    if (checked.status !== 0) throw new Error(`nginx does not take the configuration: ${checked.stderr}`);
    this.#nginx = spawn(nginxProgram(), ['-c', file, '-p', this.#folder], { stdio: 'ignore' });
    this.url = `http://127.0.0.1:${port}/`;
    await until('the start of nginx', async () => await statusOf(`${this.url}healthz`) === 200);
  }

  /** One metric of each replica, without labels; 0 of one that is gone. */
  metric(name) {
    return Promise.all(this.replicas.map(async (replica) => {
      try {
        const text = await (await fetch(`${replica.url}metrics`)).text();
        return Number(new RegExp(`^${name} (\\S+)$`, 'm').exec(text)?.[1] ?? 0);
      } catch {
        return 0;
      }
    }));
  }

  /** The last lines of all logs, for what went wrong. */
  logs() {
    return this.replicas.map((replica) => `${replica.log}:\n${readFileSync(replica.log, 'utf8').slice(-1500)}`).join('\n');
  }

  async stop() {
    await Promise.all(this.replicas.map((replica) => replica.ended && replica.stop('SIGKILL')));
    if (this.#nginx) {
      const ended = new Promise((done) => { this.#nginx.on('exit', done); });
      this.#nginx.kill('SIGTERM');
      await ended;
    }
    rmSync(this.#folder, { recursive: true, force: true });
  }
}
