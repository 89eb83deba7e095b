// The tool rail: a registry of what one can do with the picture. A tool that is not registered has no button, and one that comes
// later - measuring, clipping, a profile, annotations - appears at the place that is kept for it; the others do not change
// their order.
//
//   rail.register({ id: 'views', label: 'Views', tip: 'Suggested views (V)', icon: 'views', key: 'v', activate() {} })
//
// Tools that are more than a button are registered by page_tools.js, and loaded when they are first used. Tools of one `mode` exclude each other, as radio buttons do: orbit and look around, say. The others act when they are pressed.

import { icon } from './icons.js';

/** The rail from its top to its end; a line stands between two groups that both have tools. */
export const places = [
  ['orbit', 'look', 'fly'],
  ['measure', 'clip', 'filter', 'profile', 'annotate'],
  ['views', 'together', 'compare', 'picture', 'export', 'present'],
];

/** Where a tool stands: [group, place in it]; what the rail does not know comes last. Pure. */
export function placeOf(id) {
  const group = places.findIndex((ids) => ids.includes(id));
  return group < 0 ? [places.length, 0] : [group, places[group].indexOf(id)];
}

export class ToolRail {
  #element;
  #tools = new Map(); // id → { tool, button }
  #groups;

  constructor(element) {
    this.#element = element;
    this.#groups = [...places, []].map(() => {
      const group = document.createElement('div');
      group.className = 'group';
      group.hidden = true;
      return group;
    });
    element.replaceChildren(...this.#groups);
  }

  /**
   * `tool`: { id, label, tip, icon, activate() } and, where it has them, key (a letter that activates it, without any other key),
   * mode (a name: it excludes others of that mode), elementId (of its button). Returns its button.
   */
  register(tool) {
    if (this.#tools.has(tool.id)) throw new Error(`There is a tool "${tool.id}" already.`);
    const button = document.createElement('button');
    button.type = 'button';
    button.id = tool.elementId ?? `tool-${tool.id}`;
    button.title = tool.tip ?? tool.label;
    if (tool.mode) button.setAttribute('aria-pressed', 'false');
    const words = document.createElement('span');
    words.textContent = tool.label;
    button.append(icon(tool.icon), words);
    button.addEventListener('click', () => this.activate(tool.id));
    const [group, place] = placeOf(tool.id);
    const after = [...this.#groups[group].children].find((/** @type {any} */ other) => Number(other.dataset.place) > place);
    button.dataset.place = String(place);
    this.#groups[group].insertBefore(button, after ?? null);
    this.#groups[group].hidden = false;
    this.#tools.set(tool.id, { tool, button });
    return button;
  }

  remove(id) {
    const known = this.#tools.get(id);
    if (!known) return;
    this.#tools.delete(id);
    const group = known.button.parentElement;
    known.button.remove();
    group.hidden = group.children.length === 0;
  }

  activate(id) {
    const known = this.#tools.get(id);
    if (!known || known.button.disabled) return;
    if (known.tool.mode) this.setMode(id);
    known.tool.activate(known.button);
  }

  /** Shows this tool as the one of its mode that is on, and does nothing else. */
  setMode(id) {
    const chosen = this.#tools.get(id);
    if (!chosen) return;
    for (const { tool, button } of this.#tools.values()) {
      if (tool.mode === chosen.tool.mode) button.setAttribute('aria-pressed', String(tool.id === id));
    }
  }

  /** The tool that a key stands for, as keydown names it. */
  withKey(key) {
    return [...this.#tools.values()].find(({ tool }) => tool.key === key)?.tool.id;
  }

  get element() {
    return this.#element;
  }
}
