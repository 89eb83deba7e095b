// Items of version 4 of a LAZ chunk, beside the point itself: colours, infrared, extra bytes. laz-perf knows version 3
// only, which keeps its memory of the last value differently once a chunk changes from one scanner channel to another.
// The point itself is the same in both. Pure functions on bytes; one object for one chunk.
import { ArithmeticDecoder, SymbolModel } from './arithmetic_decoder.mjs';

// What a decoder reads ahead of the symbols.
const slack = 8;
const channelByte = 15;
const colorBytes = 6;

const models = (count) => Array.from({ length: count }, () => new SymbolModel(256));
const clamp = (value) => Math.min(255, Math.max(0, value));

/// What one scanner channel remembers; `last`: the bytes behind the point of its last record.
const newChannel = (last, { colors, infrared, extra }) => ({
  last: Uint8Array.from(last),
  color: colors && { changed: new SymbolModel(128), differences: models(6) },
  infrared: infrared && { changed: new SymbolModel(4), differences: models(2) },
  extra: models(extra),
});

/// Red, green, blue of 16 bits, as bytes. A set bit of the symbol: that byte follows as its difference, red's from the last
/// red, the others' from what red's (and green's) difference lets expect. Without bit 6 all three are alike.
function decodeColor(decoder, { changed, differences }, last) {
  const before = last.slice(0, colorBytes);
  const symbol = decoder.symbol(changed);
  for (const half of [0, 1]) if (symbol & (1 << half)) last[half] += decoder.symbol(differences[half]);
  if (!(symbol & 64)) {
    last.copyWithin(2, 0, 2);
    last.copyWithin(4, 0, 2);
    return;
  }
  for (const half of [0, 1]) {
    const red = last[half] - before[half];
    const [green, blue] = [2 + half, 4 + half];
    if (symbol & (4 << half)) last[green] = clamp(before[green] + red) + decoder.symbol(differences[green]);
    if (!(symbol & (16 << half))) continue;
    const expected = Math.trunc((red + last[green] - before[green]) / 2);
    last[blue] = clamp(before[blue] + expected) + decoder.symbol(differences[blue]);
  }
}

function decodeInfrared(decoder, { changed, differences }, last) {
  const symbol = decoder.symbol(changed);
  for (const half of [0, 1]) if (symbol & (1 << half)) last[colorBytes + half] += decoder.symbol(differences[half]);
}

export class Version4Items {
  #kinds;
  #pointBytes;
  #layers;
  #channels = [];
  #last;

  /// `first`: what stands behind the point in the chunk's first, whole record. `layers`: bytes, in the order of the chunk;
  /// an empty one says that nothing ever changes.
  constructor({ hasColor, hasInfrared, pointBytes }, first, layers) {
    const extra = layers.length - (hasColor ? 1 : 0) - (hasInfrared ? 1 : 0);
    this.#kinds = { colors: hasColor, infrared: hasInfrared, extra };
    this.#pointBytes = pointBytes;
    this.#last = Uint8Array.from(first);
    this.#layers = layers.map((bytes) => ({ bytes: bytes.length, decoder: bytes.length > 0 ? new ArithmeticDecoder(bytes) : null }));
  }

  /// Whether more was read than there is.
  get overran() {
    return this.#layers.some(({ bytes, decoder }) => decoder && decoder.consumed > bytes + slack);
  }

  /// Writes the items of the next record at `at` of `heap`, where its point is already.
  complete(heap, at) {
    const number = (heap[at + channelByte] >> 4) & 3;
    const isFirst = this.#channels.length === 0;
    const channel = (this.#channels[number] ??= newChannel(this.#last, this.#kinds));
    if (!isFirst) this.#decode(channel);
    this.#last = channel.last;
    heap.set(channel.last, at + this.#pointBytes);
  }

  #decode({ last, color, infrared, extra }) {
    let layer = 0;
    const next = (act) => {
      const { decoder } = this.#layers[layer++];
      if (decoder) act(decoder);
    };
    if (color) next((decoder) => decodeColor(decoder, color, last));
    if (infrared) next((decoder) => decodeInfrared(decoder, infrared, last));
    const firstExtra = last.length - extra.length;
    extra.forEach((model, i) => next((decoder) => (last[firstExtra + i] += decoder.symbol(model))));
  }
}
