// Seeded numbers, the same on every machine: a linear congruential generator with the constants of Knuth's MMIX.
export class Random {
  #state;

  constructor(seed) {
    this.#state = BigInt(seed);
  }

  /// 0 … below - 1.
  below(below) {
    this.#state = (this.#state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number((this.#state >> 33n) % BigInt(below));
  }

  of(list) {
    return list[this.below(list.length)];
  }
}
