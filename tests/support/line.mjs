// A line with latency before a server on this machine: half a round trip between what is sent and what arrives, in both directions, and
// a whole one before a connection is there. It can be cut, and mended. Bandwidth is what this machine has.

import { createConnection, createServer } from 'node:net';

export class Line {
  #server;
  #sockets = new Set();
  #isCut = false;
  bytes = 0;
  connections = 0;

  constructor(port, roundTripMs) {
    this.#server = createServer((near) => {
      if (this.#isCut) return near.destroy();
      ++this.connections;
      near.pause();
      setTimeout(() => near.resume(), roundTripMs);
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
