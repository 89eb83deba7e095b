// How points are drawn. Three plain words come first - Sharp, Smooth, Raw -, which of the server's methods they mean depends on
// the scan; all methods, with a small picture of each, are behind a disclosure, and what can be adjusted of the chosen one is
// behind another.

import { Choices } from './choices.js';
import { element, parameterFields } from './parameter_fields.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = strings.appearance;

/**
 * What the words mean, the best first. `auto` takes what keeps texture sharp, or creases where there is no texture; ewa blends
 * along the surface and so needs surfels; the pyramidal one makes a surface of the picture alone; hqs blends only colours.
 */
const meanings = {
  sharp: ['auto', 'paraboloid', 'cone'],
  smooth: ['ewa', 'pyramid', 'hqs'],
  raw: ['point', 'square'],
};
/** Drawn as their word says, though it leads elsewhere: links and looks may name them. */
const alike = { sharp: ['paraboloid'], smooth: [], raw: [] };

/** What a method needs and this cloud does not have. Pure. */
export function lackingFor(method, cloud) {
  const has = (need) => (need === 'surfels' ? cloud?.surfels : (cloud?.attributes ?? []).some(({ name }) => name === need));
  return (method?.needs ?? []).filter((need) => !has(need));
}

const needsText = (lacking) => words.needs(lacking.map((need) => words.attributes[need] ?? need).join(', '));

/** [{ word, method, reason }]: which method each word means for this cloud; without one, the reason says why. Pure. */
export function quickChoices(methods, cloud) {
  return Object.entries(meanings).map(([word, names]) => {
    const offered = names.map((name) => methods.find((method) => method.name === name)).filter(Boolean);
    const usable = offered.find((method) => lackingFor(method, cloud).length === 0);
    if (usable) return { word, method: usable.name };
    return { word, reason: offered.length > 0 ? needsText(lackingFor(offered[0], cloud)) : words.notOffered };
  });
}

/** The word for a method, undefined where it has none. Pure. */
export const wordFor = (method, quick) => quick.find((one) => one.method === method || alike[one.word].includes(method))?.word;

export class MethodChoice {
  #methods = [];
  #quick = [];
  #fields;
  #fieldsOf;
  #view = {};
  #cloud;
  #change;
  #words;
  #all;
  #gallery; // hears when the gallery is open and what it should show

  /** `change(method)` and `tune(name, value)` hear of what was chosen; `gallery(open)` when pictures of the methods are wanted, or not. */
  constructor({ change, tune, gallery }) {
    this.#change = change;
    this.tune = tune;
    this.#gallery = gallery;
    this.#words = new Choices(find('appearance'), (word) => change(this.#quick.find((one) => one.word === word).method));
    this.#all = new Choices(find('method'), change);
    find('all-methods').addEventListener('toggle', () => gallery(find('all-methods').open));
  }

  setCatalog({ methods }) {
    this.#methods = [...methods].sort((a, b) => Number(b.name === 'auto') - Number(a.name === 'auto'));
    this.#fieldsOf = undefined;
  }

  showCloud(cloud) {
    this.#cloud = cloud;
    this.#quick = quickChoices(this.#methods, cloud);
    this.#words.fill(this.#quick.map(({ word, reason }) => ({ value: word, label: words[word], disabled: reason !== undefined, reason })));
    this.#all.fill(this.#methods.map((method) => {
      const lacking = lackingFor(method, cloud);
      const reason = lacking.length > 0 ? needsText(lacking) : '';
      const picture = element('span', { className: 'thumbnail' });
      return { value: method.name, label: method.title || method.name, tip: method.summary, picture, disabled: lacking.length > 0, reason };
    }));
    if (find('all-methods').open) this.#gallery(true);
  }

  show(view) {
    this.#view = view;
    const method = this.#methods.find((one) => one.name === view.method);
    const word = wordFor(view.method, this.#quick);
    this.#words.show(word);
    this.#all.show(view.method);
    find('method-name').textContent = method?.title ?? '';
    find('method-summary').textContent = this.#note(word, method);
    if (this.#fieldsOf !== view.method) {
      this.#fieldsOf = view.method;
      this.#fields = parameterFields(method?.parameters ?? [], (name, value) => this.tune(name, value));
      find('parameters').replaceChildren(...this.#fields.nodes);
      find('tuning').hidden = this.#fields.nodes.length === 0;
    }
    this.#fields.show(view.param);
  }

  /** What the choice means; and of the words that cannot be chosen, why. */
  #note(word, method) {
    const means = word && method?.name !== 'paraboloid' ? words[`${word}Note`] : method?.summary;
    const missing = this.#quick.filter(({ reason }) => reason !== undefined).map(({ word: other, reason }) => `${words[other]}: ${reason}.`);
    return [means, ...missing].filter(Boolean).join(' ');
  }

  /** For the gallery: the methods that this cloud can be drawn with, the chosen one first, and where their pictures go. */
  get pictures() {
    const usable = this.#methods.filter((method) => lackingFor(method, this.#cloud).length === 0).map(({ name }) => name);
    usable.sort((a, b) => Number(b === this.#view.method) - Number(a === this.#view.method));
    return usable.map((method) => ({ method, place: this.#all.pictureOf(method) }));
  }
}
