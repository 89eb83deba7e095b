// The smallest honest JPEG encoder: every 8 × 8 block is one colour (its DC coefficient). Enough for pictures whose
// colours a test can predict. Baseline, 4:4:4, tables of ITU T.81 annex K.3 cut down to what DC-only blocks need.

const dcBits = [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0];
const dcValues = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
const dcCodes = [[0b00, 2], [0b010, 3], [0b011, 3], [0b100, 3], [0b101, 3], [0b110, 3], [0b1110, 4], [0b11110, 5],
  [0b111110, 6], [0b1111110, 7], [0b11111110, 8], [0b111111110, 9]];
const endOfBlock = [0b0, 1]; // the only AC symbol there is

const word = (value) => [value >> 8, value & 255];
const segment = (marker, bytes) => [0xff, marker, ...word(bytes.length + 2), ...bytes];

class BitWriter {
  bytes = [];
  #held = 0;
  #count = 0;

  put(code, length) {
    for (let i = length - 1; i >= 0; --i) {
      this.#held = (this.#held << 1) | ((code >> i) & 1);
      if (++this.#count === 8) this.#flush();
    }
  }

  finish() {
    while (this.#count > 0) this.put(1, 1);
  }

  #flush() {
    this.bytes.push(this.#held);
    if (this.#held === 255) this.bytes.push(0);
    this.#held = 0;
    this.#count = 0;
  }
}

/** `colorAt(column, row)` gives [r, g, b] of a block; the picture is width × height px. */
export function blockJpeg(width, height, colorAt) {
  const step = 8; // a quantiser of 8 makes one DC unit one grey level
  const head = [
    0xff, 0xd8,
    ...segment(0xe0, [0x4a, 0x46, 0x49, 0x46, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0]),
    ...segment(0xdb, [0, ...new Array(64).fill(step)]),
    ...segment(0xc0, [8, ...word(height), ...word(width), 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0]),
    ...segment(0xc4, [0x00, ...dcBits, ...dcValues]),
    ...segment(0xc4, [0x10, 1, ...new Array(15).fill(0), 0]),
    ...segment(0xda, [3, 1, 0x00, 2, 0x00, 3, 0x00, 0, 63, 0]),
  ];
  const bits = new BitWriter();
  const last = [0, 0, 0];
  for (let row = 0; row < Math.ceil(height / 8); ++row) {
    for (let column = 0; column < Math.ceil(width / 8); ++column) {
      const [r, g, b] = colorAt(column, row);
      const y = 0.299 * r + 0.587 * g + 0.114 * b - 128;
      [y, 0.564 * (b - y - 128), 0.713 * (r - y - 128)].forEach((value, component) => {
        const dc = Math.max(-1023, Math.min(1023, Math.round(value)));
        const difference = dc - last[component];
        last[component] = dc;
        const size = difference === 0 ? 0 : 32 - Math.clz32(Math.abs(difference));
        bits.put(...dcCodes[size]);
        bits.put(difference < 0 ? difference + (1 << size) - 1 : difference, size);
        bits.put(...endOfBlock);
      });
    }
  }
  bits.finish();
  return Buffer.from([...head, ...bits.bytes, 0xff, 0xd9]);
}
