// The page as it lies in client/web/, in front of a real server: what is changed is there with the next reload, and
// nothing is built. With a delay, what goes either way arrives that much later, as over a far line.
//
//   scancast serve town.las &
//   node tests/browser/support/page_proxy.mjs http://127.0.0.1:8080/ [DELAY_MS]
//
// prints the address to open. The server sees its own name as Host and Origin, so it lets the page in.

import { readFileSync } from 'node:fs';
import { createServer, request } from 'node:http';
import { connect } from 'node:net';
import { extname, join, normalize } from 'node:path';
import { Transform } from 'node:stream';
import { fileURLToPath } from 'node:url';

import { policy, types, webRoot } from './fake_server.mjs';


/** A pipe that hands on everything `delay` milliseconds later, in order. */
function delayed(delay) {
  if (!(delay > 0)) return new Transform({ transform: (chunk, _, done) => done(null, chunk) });
  return new Transform({
    transform(chunk, _, done) {
      setTimeout(() => this.push(chunk), delay);
      done();
    },
    flush(done) {
      setTimeout(done, delay);
    },
    highWaterMark: 1 << 24,
  });
}

export class PageProxy {
  #server;
  #target;
  #sockets = new Set();
  /** Milliseconds in each direction; of connections that are made from now on. */
  delay;

  constructor(target, delay = 0) {
    this.#target = new URL(target);
    this.delay = delay;
  }

  /** Resolves to the page's address. */
  start(port = 0) {
    this.#server = createServer((incoming, answer) => this.#answer(incoming, answer));
    this.#server.on('upgrade', (incoming, socket, head) => this.#tunnel(incoming, socket, head));
    this.#server.on('connection', (socket) => {
      this.#sockets.add(socket);
      socket.on('close', () => this.#sockets.delete(socket));
    });
    return new Promise((resolve) => {
      this.#server.listen(port, '127.0.0.1', () => resolve(`http://127.0.0.1:${this.#server.address().port}/`));
    });
  }

  /** Nobody need stop it: it ends with the process. */
  unref() {
    this.#server.unref();
  }

  async stop() {
    for (const socket of this.#sockets) socket.destroy();
    await new Promise((resolve) => { this.#server.close(resolve); });
  }

  #headersFor(incoming) {
    const headers = { ...incoming.headers, host: this.#target.host };
    if (headers.origin) headers.origin = this.#target.origin;
    return headers;
  }

  #answer(incoming, answer) {
    const path = new URL(incoming.url, this.#target).pathname;
    const file = join(webRoot, normalize(path === '/' ? '/index.html' : path));
    if (!path.startsWith('/api/')) {
      try {
        const bytes = readFileSync(file);
        const type = types[extname(file)] ?? 'application/octet-stream';
        answer.writeHead(200, { 'Content-Type': type, 'Cache-Control': 'no-store', 'Content-Security-Policy': policy }).end(bytes);
        return;
      } catch {
        // Not of the page: the server's.
      }
    }
    const onward = request(new URL(incoming.url, this.#target), { method: incoming.method, headers: this.#headersFor(incoming) }, (came) => {
      setTimeout(() => {
        answer.writeHead(came.statusCode, came.headers);
        came.on('error', () => answer.destroy()); // broken off there: not all of it here
        came.pipe(answer);
      }, 2 * this.delay);
    });
    onward.on('error', () => answer.destroy());
    answer.on('close', () => !answer.writableFinished && onward.destroy()); // who has asked has gone
    incoming.pipe(onward);
  }

  #tunnel(incoming, socket, head) {
    const onward = connect(Number(this.#target.port || 80), this.#target.hostname);
    const { delay } = this;
    const end = () => {
      socket.destroy();
      onward.destroy();
    };
    for (const one of [socket, onward]) {
      one.setNoDelay(true);
      one.on('error', end);
      one.on('close', end);
    }
    onward.on('connect', () => {
      const lines = Object.entries(this.#headersFor(incoming)).map(([name, value]) => `${name}: ${value}\r\n`).join('');
      onward.write(`${incoming.method} ${incoming.url} HTTP/1.1\r\n${lines}\r\n`);
      if (head.length > 0) onward.write(head);
    });
    socket.pipe(delayed(delay)).pipe(onward);
    onward.pipe(delayed(delay)).pipe(socket);
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [, , target = 'http://127.0.0.1:8080/', delay = '0'] = process.argv;
  console.log(`The page of the working tree, before ${target}: ${await new PageProxy(target, Number(delay)).start()}`);
}
