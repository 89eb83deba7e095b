// Which method "Automatic" took, and why: the server tells it with a picture, and it holds for the cloud as it is.

import { strings } from './strings.js';

const words = strings.appearance;
/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

export class ChosenMethod {
  #of = '';
  #method;
  #reason = '';
  #titles = new Map();

  setMethods(methods) {
    this.#titles = new Map(methods.map(({ name, title }) => [name, title || name]));
  }

  /** `stats` of a picture of that cloud; where a method was named, they give no reason. */
  told({ method, methodReason }, cloud) {
    if (!method || !methodReason || !cloud) return;
    this.#of = `${cloud.id} ${cloud.revision}`;
    this.#method = method;
    this.#reason = methodReason;
  }

  #isKnown(view, cloud) {
    return view.method === 'auto' && cloud !== undefined && this.#of === `${cloud.id} ${cloud.revision}`;
  }

  /** What a method is called; `auto`, by the one that it came to, where that is known. */
  title(name) {
    const shown = name === 'auto' && this.#method ? this.#method : name;
    return this.#titles.get(shown) ?? shown;
  }

  /** The method that the view is drawn by: 'auto' where nobody knows yet which that is. */
  method(view, cloud) {
    return this.#isKnown(view, cloud) ? this.#method : view.method;
  }

  /** "Paraboloids (automatic)", or the name of the method that the view asks for. */
  words(view, cloud) {
    const title = (name) => this.#titles.get(name) ?? name;
    return this.#isKnown(view, cloud) ? words.automatic(title(this.#method)) : (title(view.method) ?? '');
  }

  /** Says it in the panel. */
  show(view, cloud) {
    const known = this.#isKnown(view, cloud);
    const title = this.#titles.get(this.#method) ?? this.#method;
    const say = (node, text) => {
      if (node && node.textContent !== text) node.textContent = text;
    };
    const automatic = this.#titles.get('auto') ?? 'auto';
    const named = known ? words.automaticIs(automatic, title) : automatic;
    say(find('method').querySelector('.choice:has([value=auto]) .name'), named);
    if (view.method === 'auto') say(find('method-name'), named);
    const reason = this.#reason.charAt(0).toUpperCase() + this.#reason.slice(1);
    say(find('method-chosen'), known ? words.chosen(title, reason) : '');
  }
}
