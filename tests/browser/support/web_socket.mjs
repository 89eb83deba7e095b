// Just enough of RFC 6455, server side, for a test double: text and binary messages up to 4 GiB out, text messages in,
// no fragmentation, no extensions. Never use it for anything else.

import { createHash } from 'node:crypto';

const guid = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';

export class TestSocket {
  onText = () => {};
  onClose = () => {};
  closeCode; // that the client has sent
  #socket;
  #pending = Buffer.alloc(0);

  constructor(request, socket) {
    this.#socket = socket;
    const accept = createHash('sha1').update(request.headers['sec-websocket-key'] + guid).digest('base64');
    socket.write(
      ['HTTP/1.1 101 Switching Protocols', 'Upgrade: websocket', 'Connection: Upgrade',
        `Sec-WebSocket-Accept: ${accept}`, 'Sec-WebSocket-Protocol: scancast.v1', '', ''].join('\r\n'),
    );
    socket.setNoDelay(true);
    socket.on('data', (data) => this.#received(data));
    socket.on('error', () => {});
    socket.on('close', () => this.onClose());
  }

  sendText(text) {
    this.#send(0x81, Buffer.from(text));
  }

  sendBinary(...parts) {
    this.#send(0x82, Buffer.concat(parts));
  }

  close(code, reason = '') {
    const body = Buffer.concat([Buffer.from([code >> 8, code & 255]), Buffer.from(reason)]);
    this.#send(0x88, body);
    this.#socket.end();
  }

  /** As if the cable had been cut. */
  destroy() {
    this.#socket.destroy();
  }

  #send(first, payload) {
    if (this.#socket.destroyed) return;
    const { length } = payload;
    const head = length < 126 ? Buffer.from([first, length]) : Buffer.alloc(length < 65536 ? 4 : 10);
    if (length >= 126) {
      head[0] = first;
      head[1] = length < 65536 ? 126 : 127;
      if (length < 65536) head.writeUInt16BE(length, 2);
      else head.writeBigUInt64BE(BigInt(length), 2);
    }
    this.#socket.write(Buffer.concat([head, payload]));
  }

  #received(data) {
    this.#pending = Buffer.concat([this.#pending, data]);
    for (;;) {
      const all = this.#pending;
      if (all.length < 6) return;
      const short = all[1] & 127;
      const offset = short === 126 ? 8 : short === 127 ? 14 : 6;
      if (all.length < offset) return;
      const length = short === 126 ? all.readUInt16BE(2) : short === 127 ? Number(all.readBigUInt64BE(2)) : short;
      if (all.length < offset + length) return;
      const mask = all.subarray(offset - 4, offset);
      const payload = Buffer.from(all.subarray(offset, offset + length)).map((byte, i) => byte ^ mask[i & 3]);
      this.#pending = all.subarray(offset + length);
      if ((all[0] & 15) === 1) this.onText(Buffer.from(payload).toString());
      if ((all[0] & 15) === 8) {
        this.closeCode = payload.length >= 2 ? payload.readUInt16BE(0) : 1005;
        this.#socket.end();
      }
    }
  }
}
