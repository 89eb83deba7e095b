// The arithmetic coder of LASzip, as far as chunk tables and items of version 4 need it: symbols, raw bits, and
// integers predicted from the one before. 32-bit arithmetic as in its reference; numbers stay exact because every product is of 32 bits.
const minLength = 0x01000000;
const lengthShift = 15;
const maxCount = 1 << lengthShift;
const bitLengthShift = 13;
const bitMaxCount = 1 << bitLengthShift;

class BitModel {
  zeros = 1;
  count = 2;
  zeroProbability = 1 << (bitLengthShift - 1);
  cycle = 4;
  untilUpdate = 4;

  update() {
    this.count += this.cycle;
    if (this.count > bitMaxCount) {
      this.count = (this.count + 1) >>> 1;
      this.zeros = (this.zeros + 1) >>> 1;
      if (this.zeros === this.count) ++this.count;
    }
    const scale = Math.floor(0x80000000 / this.count);
    this.zeroProbability = Math.imul(this.zeros, scale) >>> (31 - bitLengthShift);
    this.cycle = Math.min(64, (5 * this.cycle) >>> 2);
    this.untilUpdate = this.cycle;
  }
}

/// How likely each of `symbols` symbols is, learnt while they are decoded.
export class SymbolModel {
  constructor(symbols) {
    this.symbols = symbols;
    this.distribution = new Uint32Array(symbols);
    this.counts = new Uint32Array(symbols).fill(1);
    this.total = 0;
    this.cycle = symbols;
    this.update();
    this.untilUpdate = this.cycle = (symbols + 6) >>> 1;
  }

  update() {
    this.total += this.cycle;
    if (this.total > maxCount) {
      this.total = 0;
      for (let i = 0; i < this.symbols; ++i) this.total += this.counts[i] = (this.counts[i] + 1) >>> 1;
    }
    const scale = Math.floor(0x80000000 / this.total);
    for (let i = 0, sum = 0; i < this.symbols; sum += this.counts[i++])
      this.distribution[i] = Math.imul(scale, sum) >>> (31 - lengthShift);
    this.cycle = Math.min((5 * this.cycle) >>> 2, (this.symbols + 6) << 3);
    this.untilUpdate = this.cycle;
  }
}

/// Reads `bytes` from front to back; behind their end come zeros, at most `slack` of them.
export class ArithmeticDecoder {
  #bytes;
  #at = 0;
  #value;
  #length = 0xffffffff;

  constructor(bytes) {
    this.#bytes = bytes;
    this.#value = 0;
    for (let i = 0; i < 4; ++i) this.#value = ((this.#value << 8) | this.#byte()) >>> 0;
  }

  /// How many bytes were asked for, perhaps more than there are.
  get consumed() {
    return this.#at;
  }

  #byte() {
    return this.#bytes[this.#at++] ?? 0;
  }

  #renormalize() {
    // A damaged stream can bring the interval to nothing; four bytes is all that a sound one ever needs.
    for (let i = 0; i < 4 && this.#length < minLength; ++i) {
      this.#value = ((this.#value << 8) | this.#byte()) >>> 0;
      this.#length = (this.#length << 8) >>> 0;
    }
  }

  bit(model) {
    const x = Math.imul(model.zeroProbability, this.#length >>> bitLengthShift) >>> 0;
    const one = this.#value >= x;
    if (one) {
      this.#value -= x;
      this.#length -= x;
    } else {
      this.#length = x;
      ++model.zeros;
    }
    this.#renormalize();
    if (--model.untilUpdate === 0) model.update();
    return one ? 1 : 0;
  }

  symbol(model) {
    let y = this.#length;
    let x = 0;
    let symbol = 0;
    let above = model.symbols;
    this.#length >>>= lengthShift;
    for (let middle = above >>> 1; middle !== symbol; middle = (symbol + above) >>> 1) {
      const z = Math.imul(this.#length, model.distribution[middle]) >>> 0;
      if (z > this.#value) {
        above = middle;
        y = z;
      } else {
        symbol = middle;
        x = z;
      }
    }
    this.#value = (this.#value - x) >>> 0;
    this.#length = (y - x) >>> 0;
    this.#renormalize();
    ++model.counts[symbol];
    if (--model.untilUpdate === 0) model.update();
    return symbol;
  }

  bits(count) {
    if (count > 19) {
      const low = this.bits(16);
      return ((this.bits(count - 16) << 16) | low) >>> 0;
    }
    this.#length >>>= count;
    const value = this.#length === 0 ? 0 : Math.floor(this.#value / this.#length);
    this.#value = (this.#value - Math.imul(this.#length, value)) >>> 0;
    this.#renormalize();
    return value;
  }
}

/// Integers of 32 bits, each as its difference from a prediction.
export class IntegerDecoder {
  #kinds;
  #correctors = [];
  #oneBit = new BitModel();

  constructor(contexts) {
    this.#kinds = Array.from({ length: contexts }, () => new SymbolModel(33));
    for (let i = 1; i <= 32; ++i) this.#correctors.push(new SymbolModel(1 << Math.min(i, 8)));
  }

  decode(decoder, prediction, context) {
    return (prediction + this.#correction(decoder, this.#kinds[context])) >>> 0;
  }

  #correction(decoder, kinds) {
    const k = decoder.symbol(kinds);
    if (k === 0) return decoder.bit(this.#oneBit);
    if (k >= 32) return -0x80000000;
    let c = decoder.symbol(this.#correctors[k - 1]);
    if (k > 8) c = c * 2 ** (k - 8) + decoder.bits(k - 8);
    return c >= 2 ** (k - 1) ? c + 1 : c - (2 ** k - 1);
  }
}
