// The classes that a cloud has, in the panel: which of them are shown, how many points each has, and in which colour it is drawn where
// colours show classes. Names, counts and colours are the server's.

import { element } from '../parameter_fields.js';
import { amount } from '../strings.js';
import { planStrings } from '../strings/plan.js';
import { classesOf } from './legend.js';

const words = planStrings.classes;
/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

/** The view's word for showing these of the classes that there are: null for all of them, as nobody need say. Pure. */
export const classesWord = (shown, all) => (all.every((number) => shown.includes(number)) ? null : all.filter((number) => shown.includes(number)));

/** Those of `all` that a view with that word shows. Pure. */
export const shownBy = (word, all) => (word ? all.filter((number) => word.includes(number)) : all);

/** The word once one class is shown that was not, or the other way round. Pure. */
export function toggled(word, all, number) {
  const shown = shownBy(word, all);
  return classesWord(shown.includes(number) ? shown.filter((one) => one !== number) : [...shown, number], all);
}

/** The word for that class alone; where it is alone already, for all. Pure. */
export function onlyOne(word, all, number) {
  const shown = shownBy(word, all);
  return shown.length === 1 && shown[0] === number ? null : classesWord([number], all);
}

export class ClassList {
  #root = find('classes');
  #list = element('ul', { id: 'class-list' });
  #state = element('p', { className: 'note' });
  #all = [];
  #word = null;
  #of = ''; // what the list is of
  #boxes = new Map(); // number → checkbox

  /** `change(word)` hears what the view is to show: null or a list of classes. */
  constructor(change) {
    const button = (label, tip, word) => {
      const made = element('button', { type: 'button', textContent: label, title: tip });
      made.addEventListener('click', () => change(word()));
      return made;
    };
    this.#state.setAttribute('role', 'status');
    this.#list.setAttribute('aria-label', words.list);
    this.#list.addEventListener('change', (event) => change(toggled(this.#word, this.#all, Number(/** @type {any} */ (event.target).value))));
    this.#list.addEventListener('click', (event) => {
      const only = /** @type {any} */ (event.target).closest('.only');
      if (only) change(onlyOne(this.#word, this.#all, Number(only.value)));
    });
    this.#root.replaceChildren(
      element('div', { className: 'row heading' }, element('h3', { textContent: words.title }),
        button(words.all, words.allTip, () => null), button(words.none, words.noneTip, () => [])),
      this.#list, this.#state);
  }

  show(view, cloud) {
    this.#all = cloud?.classes ?? [];
    this.#word = view.classes ?? null;
    this.#root.hidden = this.#all.length === 0;
    if (this.#root.hidden) return;
    const of = JSON.stringify([cloud.id, cloud.revision, this.#all]);
    if (of !== this.#of) this.#fill(cloud);
    this.#of = of;
    const shown = shownBy(this.#word, this.#all);
    for (const [number, box] of this.#boxes) box.checked = shown.includes(number);
    const said = words.shown(shown.length, this.#all.length);
    if (this.#state.textContent !== said) this.#state.textContent = said;
  }

  #fill(cloud) {
    this.#boxes.clear();
    this.#list.replaceChildren(...classesOf(cloud).map((one) => this.#row(one)));
  }

  #row({ number, name, color, count }) {
    const box = element('input', { type: 'checkbox', value: String(number) });
    this.#boxes.set(number, box);
    const swatch = element('i', { className: 'swatch' });
    swatch.style.background = color;
    const only = element('button', { type: 'button', className: 'only', value: String(number), textContent: words.only });
    only.setAttribute('aria-label', words.onlyNamed(name));
    const label = element('label', { title: `${number}: ${words.points(count)}` }, box, swatch, element('span', { className: 'name', textContent: name }),
      element('span', { className: 'count', textContent: amount(count) }));
    return element('li', {}, label, only);
  }
}
