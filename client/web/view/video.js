// A connection's moving frames as video: H.264 to bitmaps, by the browser's decoder (WebCodecs). Each frame builds on the one before,
// so each that comes is decoded, whether or not it is shown. Loaded when the first one comes.

const patienceMs = 8000; // a decoder that holds frames back, or has died without a word, is none; a busy machine may take its time

/** What the first parameter set says of the stream, as WebCodecs wants it: "avc1.42c01f"; '' where there is none. Pure. */
export function codecOf(bytes) {
  for (let at = 0; at + 6 < bytes.length; at += 1) {
    const starts = bytes[at] === 0 && bytes[at + 1] === 0 && bytes[at + 2] === 1;
    if (!starts || (bytes[at + 3] & 31) !== 7) continue;
    return `avc1.${[...bytes.subarray(at + 4, at + 7)].map((byte) => byte.toString(16).padStart(2, '0')).join('')}`;
  }
  return '';
}

export class Video {
  #decoder;
  #codec = '';
  #waiting = new Map(); // timestamp → { frame, done, failed, timer }
  #count = 0;

  /** Resolves to the frame's bitmap; rejects where it cannot be decoded, and so do all up to the next key. In the order in which frames come. */
  decode(frame) {
    return new Promise((done, failed) => {
      try {
        if (frame.key) this.#begin(codecOf(frame.picture));
        if (this.#decoder?.state !== 'configured') throw new Error('It begins without a key.');
        this.#count += 1;
        const timestamp = this.#count;
        const timer = setTimeout(() => this.#end(new Error('The decoder holds frames back.')), patienceMs);
        this.#waiting.set(timestamp, { frame, done, failed, timer });
        this.#decoder.decode(new EncodedVideoChunk({ type: frame.key ? 'key' : 'delta', timestamp, data: frame.picture }));
      } catch (error) {
        this.#end(error);
        failed(error);
      }
    });
  }

  close() {
    this.#end(new Error('The connection has ended.'));
  }

  #begin(codec) {
    if (this.#decoder?.state === 'configured' && codec === this.#codec) return;
    if (!this.#decoder || this.#decoder.state === 'closed') {
      this.#decoder = new VideoDecoder({
        output: (picture) => this.#decoded(picture),
        error: (error) => this.#end(error),
      });
    }
    this.#codec = codec;
    this.#decoder.configure({ codec, optimizeForLatency: true });
  }

  async #decoded(picture) {
    const asked = this.#waiting.get(picture.timestamp);
    this.#waiting.delete(picture.timestamp);
    clearTimeout(asked?.timer);
    try {
      // An odd side comes one longer.
      if (asked) asked.done(await createImageBitmap(picture, 0, 0, asked.frame.width, asked.frame.height));
    } catch (error) {
      asked?.failed(error);
    } finally {
      picture.close();
    }
  }

  #end(error) {
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    for (const { failed, timer } of waiting) {
      clearTimeout(timer);
      failed(error);
    }
    if (this.#decoder && this.#decoder.state !== 'closed') this.#decoder.close();
    this.#decoder = undefined;
  }
}
