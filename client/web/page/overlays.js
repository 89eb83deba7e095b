// What lies over the picture now and then: a message about something refused, and the help. The cover is in cover.js.

import { keyTable } from '../view/keys.js';
import { element } from './parameter_fields.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const toastMs = 9000;

export class Overlays {
  #toastTimer;

  constructor() {
    find('toast-close').addEventListener('click', () => this.dismiss());
    find('show-help').addEventListener('click', () => this.toggleHelp());
    find('help').addEventListener('click', (event) => {
      if (event.target === find('help')) find('help').close(); // a click beside it
    });
    find('help-keys').replaceChildren(
      ...keyTable.flatMap(([keys, meaning]) => [
        element('dt', {}, ...keys.split(' ').map((key) => element('kbd', { textContent: key }))),
        element('dd', { textContent: meaning }),
      ]),
    );
  }

  toggleHelp() {
    const help = find('help');
    if (help.open) help.close();
    else {
      help.showModal();
      help.scrollTop = 0; // the button that has the focus is at its end
    }
  }

  /** A message that goes away by itself. */
  toast(title, detail, kind = 'problem') {
    clearTimeout(this.#toastTimer);
    const toast = find('toast');
    toast.dataset.kind = kind;
    toast.hidden = false;
    find('toast-title').textContent = title;
    find('toast-detail').textContent = detail ?? '';
    this.#toastTimer = setTimeout(() => this.dismiss(), kind === 'problem' ? toastMs : 2500);
  }

  dismiss() {
    find('toast').hidden = true;
  }
}
