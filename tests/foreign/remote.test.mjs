// Clouds in object storage, served by programs that are not ours: nginx for https:// and http://, s3rver for s3:// with signatures
// that it checks, and a line with latency that can be cut in front of them. What is right is what the same file gives on disk.

import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { createConnection, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import S3rver from 's3rver';
import WebSocket from 'ws';

import { RealServer } from '../browser/support/real_server.mjs';

const program = process.env.SCANCAST_PROGRAM;
const patienceMs = 30_000;
const roundTripMs = 50;
const picture = ['--width', '320', '--height', '200', '--backend', 'cpu'];
const hasNginx = spawnSync('nginx', ['-v']).status === 0;
const skip = hasNginx ? false : 'nginx is missing: apt-get install nginx-light';

let folder, nginx, s3, line;

/** Ends of a TCP connection, with half a round trip between what is sent and what arrives. `cut()`: nothing gets through. */
class Line {
  #server;
  #sockets = new Set();
  #isCut = false;
  bytes = 0;
  connections = 0;

  constructor(port) {
    this.#server = createServer((near) => {
      if (this.#isCut) return near.destroy();
      ++this.connections;
      const far = createConnection(port, '127.0.0.1');
      for (const [from, to] of [[near, far], [far, near]]) {
        this.#sockets.add(from);
        from.on('data', (data) => {
          if (from === far) this.bytes += data.length;
          setTimeout(() => to.write(data), roundTripMs / 2);
        });
        from.on('close', () => setTimeout(() => to.destroy(), roundTripMs / 2));
        from.on('error', () => {});
      }
    });
  }

  start() {
    return new Promise((done) => this.#server.listen(0, '127.0.0.1', () => done(this.#server.address().port)));
  }

  cut() {
    this.#isCut = true;
    for (const socket of this.#sockets) socket.destroy();
    this.#sockets.clear();
  }

  mend() {
    this.#isCut = false;
  }

  stop() {
    this.cut();
    this.#server.close();
  }
}

function run(words, environment = {}) {
  const ran = spawnSync(program, words, { env: { ...process.env, ...environment }, encoding: 'utf8' });
  return { code: ran.status, said: ran.stdout + ran.stderr };
}

async function comesTrue(condition, what) {
  const end = Date.now() + patienceMs;
  while (!await condition()) {
    assert.ok(Date.now() < end, `${what} within ${patienceMs} ms`);
    await new Promise((done) => setTimeout(done, 25));
  }
}

async function freePort() {
  const server = createServer();
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

async function startNginx() {
  const [plain, secure] = [await freePort(), await freePort()];
  for (const name of ['certificate', 'logs', 'web']) mkdirSync(join(folder, name));
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '2', '-subj', '/CN=localhost',
    '-addext', 'subjectAltName=DNS:localhost', '-keyout', join(folder, 'certificate/key.pem'), '-out', join(folder, 'certificate/cert.pem')], { stdio: 'ignore' });
  const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((name) => `${name}_temp_path ${folder}/${name};`).join(' ');
  writeFileSync(join(folder, 'nginx.conf'), `
    daemon off; worker_processes 1; pid ${folder}/pid; error_log ${folder}/logs/error.log;
    events { worker_connections 256; }
    http {
      access_log ${folder}/logs/access.log; ${temporary}
      server {
        listen 127.0.0.1:${plain};
        listen 127.0.0.1:${secure} ssl http2;
        ssl_certificate ${folder}/certificate/cert.pem; ssl_certificate_key ${folder}/certificate/key.pem;
        root ${folder}/web;
        location /signed/ { limit_except GET { deny all; } if ($request_method = HEAD) { return 403; } alias ${folder}/web/; }
        location /down/ { return 302 http://127.0.0.1:${plain}/town.scan; }
        location /moved/ { return 302 /town.scan; }
        location /loop/ { return 302 /loop/town.scan; }
        location /whole/ { max_ranges 0; alias ${folder}/web/; }
      }
    }`);
  const child = spawn('nginx', ['-p', folder, '-c', join(folder, 'nginx.conf')], { stdio: 'ignore' });
  await comesTrue(() => fetch(`http://127.0.0.1:${plain}/town.scan`).then((got) => got.ok, () => false), 'nginx answers');
  return { child, plain: `http://127.0.0.1:${plain}`, secure: `https://localhost:${secure}`, port: plain };
}

async function startS3() {
  const directory = join(folder, 's3');
  mkdirSync(directory);
  const server = new S3rver({ port: 0, address: '127.0.0.1', silent: true, directory, configureBuckets: [{ name: 'scans', configs: [] }] });
  const { port } = await server.run();
  const environment = {
    AWS_ACCESS_KEY_ID: 'S3RVER', AWS_SECRET_ACCESS_KEY: 'S3RVER', AWS_SESSION_TOKEN: '', AWS_REGION: 'us-east-1', AWS_ENDPOINT_URL: `http://127.0.0.1:${port}`,
  };
  // curl signs by itself what ours asks curl's library to sign.
  execFileSync('curl', ['-sS', '--fail', '--aws-sigv4', 'aws:amz:us-east-1:s3', '--user', 'S3RVER:S3RVER', '-T', join(folder, 'web/town.scan'),
    `http://127.0.0.1:${port}/scans/area/town.scan`]);
  return { server, environment };
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'scancast-remote-'));
  mkdirSync(join(folder, 'scan'));
  for (const [name, seed] of [['town', 1], ['other', 2]]) {
    execFileSync(program, ['generate', 'town', '--points', '150k', '--seed', String(seed), '-o', join(folder, `scan/${name}.las`)], { stdio: 'ignore' });
    execFileSync(program, ['ingest', join(folder, `scan/${name}.las`), '-o', join(folder, `scan/${name}.scan`)], { stdio: 'ignore' });
  }
  if (!hasNginx) return;
  mkdirSync(join(folder, 'web'));
  copyFileSync(join(folder, 'scan/town.scan'), join(folder, 'web/town.scan'));
  rmSync(join(folder, 'web'), { recursive: true });
  const started = await (async () => {
    const promise = startNginxWithTown();
    return promise;
  })();
  nginx = started;
  s3 = await startS3();
  line = new Line(nginx.port);
  line.port = await line.start();
  assert.equal(run(['render', join(folder, 'scan/town.scan'), '-o', join(folder, 'here.png'), ...picture]).code, 0);
});
