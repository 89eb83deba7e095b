// Parts of the page that come when they are first used: a module, by import(), and the style sheets that are its own. The page's first
// load has of each no more than its button.
//
//   const tools = new LazyTools(rail, overlays);
//   tools.add({
//     id: 'measure', label: 'Measure', tip: 'Measure (M)', icon: 'measure', key: 'm',       // as rail.register() has them
//     styles: ['card.css', 'measure.css'],                                                  // in styles/
//     load: async (active) => new (await import('../measure/measuring.js')).Measuring(viewer, { active }),
//   });
//
// Such a tool has `isActive` and `activate(isActive = !this.isActive)`, and calls `active(isActive)` when it opens and when it closes: there
// is room for one card, so one that opens closes the others. What has no button is a LazyPart.

import { fillStrings, strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const sheets = new Map(); // name → promise

function load(name) {
  return new Promise((done, failed) => {
    const link = Object.assign(document.createElement('link'), { rel: 'stylesheet', href: new URL(`../styles/${name}`, import.meta.url).href });
    link.addEventListener('load', () => done(link));
    link.addEventListener('error', () => {
      link.remove();
      failed(new Error(`styles/${name} could not be loaded.`));
    });
    document.head.append(link);
  });
}

/** Resolves when that file of styles/ holds for the page; rejects where it cannot be had, and is asked for anew the next time. */
export function loadStyle(name) {
  if (!sheets.has(name)) sheets.set(name, load(name).catch((error) => {
    sheets.delete(name);
    throw error;
  }));
  return sheets.get(name);
}

/** Puts a card (styles/card.css) beside the rail, and returns it; `words` has the strings that its data-text, data-label and data-tip name. */
export function putCard(markup, words) {
  const template = document.createElement('template');
  template.innerHTML = markup;
  fillStrings(template.content, words);
  const [card] = /** @type {any} */ (template.content.children);
  find('hud').before(template.content);
  return card;
}

export class LazyPart {
  #styles;
  #load;
  #overlays;
  #coming; // promise of it, from when it is first wanted
  made; // undefined until it is there

  /** `load()` imports and makes it; `styles` are there before. */
  constructor({ styles = [], load }, overlays) {
    this.#styles = styles;
    this.#load = load;
    this.#overlays = overlays;
  }

  /** Resolves to it, or to undefined where it could not be loaded, which has been said then. */
  get() {
    this.#coming ??= this.#come();
    return this.#coming;
  }

  async #come() {
    try {
      await Promise.all(this.#styles.map(loadStyle));
      this.made = await this.#load();
    } catch (error) {
      this.#coming = undefined; // the next press tries again
      console.warn(error);
      this.#overlays.toast(strings.tools.notLoaded, strings.tools.notLoadedDetail);
    }
    return this.made;
  }
}

export class LazyTools {
  #rail;
  #overlays;
  #tools = new Map(); // id → { part, button, key }
  #wanted; // the one that was pressed last

  constructor(rail, overlays) {
    this.#rail = rail;
    this.#overlays = overlays;
  }

  /** `load(active)` resolves to the tool; its button is pressed while it is open. */
  add({ id, styles, load, ...look }) {
    const part = new LazyPart({ styles, load: () => load((isActive) => this.#changed(id, isActive)) }, this.#overlays);
    const button = this.#rail.register({ id, ...look, activate: () => this.toggle(id) });
    button.setAttribute('aria-pressed', 'false');
    this.#tools.set(id, { part, button, key: look.key });
  }

  has(id) { return this.#tools.has(id); }

  /** The tool, where it has been loaded. */
  made(id) { return this.#tools.get(id)?.part.made; }

  /** Loads it where it has not been; undefined where it cannot be. */
  get(id) { return this.#tools.get(id).part.get(); }

  /** Whether the key opens one of these. */
  hasKey(key) { return [...this.#tools.values()].some((tool) => tool.key === key); }

  async toggle(id) {
    const { part, button } = this.#tools.get(id);
    this.#wanted = id;
    if (part.made) {
      part.made.activate();
      return;
    }
    button.setAttribute('aria-busy', 'true');
    const tool = await part.get();
    button.removeAttribute('aria-busy');
    if (this.#wanted === id) tool?.activate(); // else another one was pressed meanwhile
  }

  /** Whatever is open. */
  close() {
    this.#wanted = undefined;
    for (const { part } of this.#tools.values()) if (part.made?.isActive) part.made.activate(false);
  }

  #changed(id, isActive) {
    this.#tools.get(id).button.setAttribute('aria-pressed', String(isActive));
    for (const [other, { part }] of this.#tools) if (isActive && other !== id && part.made?.isActive) part.made.activate(false);
    document.body.classList.toggle('with-card', [...this.#tools.values()].some(({ part }) => part.made?.isActive));
  }
}
