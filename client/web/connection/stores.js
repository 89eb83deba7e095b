// What the browser keeps for the page: for this tab, or on this device. Where the browser keeps nothing - a private window, a
// setting -, it is kept as long as the page stays open.

class Store {
  #name;
  #here = new Map();

  /** `name`: 'sessionStorage' or 'localStorage'. */
  constructor(name) {
    this.#name = name;
  }

  get(key) {
    try {
      return globalThis[this.#name].getItem(key) ?? this.#here.get(key);
    } catch {
      return this.#here.get(key);
    }
  }

  set(key, value) {
    this.#here.set(key, value);
    try {
      globalThis[this.#name].setItem(key, value);
    } catch {
      // Kept here, then.
    }
  }

  remove(key) {
    this.#here.delete(key);
    try {
      globalThis[this.#name].removeItem(key);
    } catch {
      // Nothing is there that could be removed.
    }
  }
}

export const tabStore = new Store('sessionStorage');
export const deviceStore = new Store('localStorage');
