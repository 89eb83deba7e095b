// How a viewer's moving frames come: as video where browser and server can, else as JPEG. What hello says of it, the decoder, which is
// loaded when it is needed, and the way back to JPEG where it fails.

const asked = { codec: 'avc1.42c033', optimizeForLatency: true }; // what most decoders know: level 5.1; larger pictures fail and come as JPEG
const patienceMs = 1000;

/** Whether this browser decodes H.264 for pages. They have to come by https, or from this machine. */
async function hasDecoder() {
  if (!globalThis.isSecureContext || !('VideoDecoder' in globalThis)) return false;
  const late = new Promise((done) => setTimeout(done, patienceMs, false));
  const support = VideoDecoder.isConfigSupported(asked).then(({ supported }) => supported, () => false);
  return Promise.race([support, late]);
}

export class MovingFrames {
  #onFailed;
  #can = false;
  #loading; // promise of the decoder
  #video;
  /** Resolves when it is known what this browser can. */
  ready = hasDecoder().then((can) => { this.#can = can; });
  /** What the newest welcome said: { movingCodec, codecReason }. */
  #said = {};
  #hasFailed = false;

  /** `onFailed`: the video cannot be shown; connections from now on are asked for JPEG. */
  constructor(onFailed) {
    this.#onFailed = onFailed;
  }

  /** For hello. */
  get words() { return this.#can && !this.#hasFailed ? { codecs: ['h264', 'jpeg'] } : {}; }

  /** How moving frames come: { codec, reason }; the reason, where there is one, is a sentence. */
  get now() {
    return { codec: this.#said.movingCodec ?? 'jpeg', hasFailed: this.#hasFailed, reason: this.#said.codecReason ?? '' };
  }

  /** Another connection begins. */
  begin(welcome) {
    this.#said = welcome;
    this.#video?.close();
    this.#video = this.#loading = undefined;
    // Its hello may have been said before the video of the one before failed.
    if (this.#hasFailed && welcome.movingCodec === 'h264') this.#onFailed();
  }

  /** A frame of a connection, each in turn: promise of its bitmap, where it is video; undefined where it is none. */
  decode(frame) {
    if (frame.codec !== 'h264') return undefined;
    this.#loading ??= import('./video.js').then(({ Video }) => { this.#video = new Video(); return this.#video; });
    const bitmap = this.#loading.then((video) => video.decode(frame));
    bitmap.catch((error) => this.#failed(error));
    return bitmap;
  }

  #failed(error) {
    if (this.#hasFailed || !this.#loading) return; // or of a connection that is gone
    console.warn(error);
    this.#hasFailed = true;
    this.#onFailed();
  }
}
