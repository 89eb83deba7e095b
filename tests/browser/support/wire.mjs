// What a page says to its server and is sent, overheard: from where it looks, and what of the surface its newest picture
// shows. So tests know the camera without asking the page.

import { unpackDepth } from '../../../client/web/protocol/frame_depth.js';
import { parseFrame } from '../../../client/web/protocol/frame_header.js';

export class Wire {
  /** All of the view that was asked for last, in the protocol's words. */
  view = {};
  /** The newest frame with its header's fields. */
  frame;

  /** Before `page` goes anywhere. */
  constructor(page) {
    page.on('websocket', (socket) => {
      socket.on('framesent', ({ payload }) => {
        if (typeof payload !== 'string') return;
        const { type, ...rest } = JSON.parse(payload);
        if (type === 'hello' || type === 'view') this.view = { ...this.view, ...rest };
      });
      socket.on('framereceived', ({ payload }) => {
        if (typeof payload === 'string') return;
        this.frame = parseFrame(payload.buffer.slice(payload.byteOffset, payload.byteOffset + payload.length));
      });
    });
  }

  /** Share of the newest picture's cells that show something; NaN where it brings no depth. */
  async covered() {
    if (!this.frame?.packedDepth) return NaN;
    const { inverse } = await unpackDepth(this.frame.packedDepth);
    return inverse.reduce((count, value) => count + (value > 0 ? 1 : 0), 0) / inverse.length;
  }
}
