// The note over a picture that shows a part only: its cloud is still being read, and how far that is.

import { Pace, progressWords } from './progress.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

export class LoadingNote {
  #pace = new Pace();

  /** `entry`: of the list, the cloud on screen; undefined for none. */
  show(entry) {
    const loading = entry?.state === 'loading';
    find('loading').hidden = !loading;
    if (!loading) return;
    const { step, share, percent, left } = progressWords(entry, this.#pace);
    find('loading-title').textContent = strings.progress.coarse(percent);
    find('loading-detail').textContent = [step, left].filter(Boolean).join(' · ');
    const bar = find('loading-progress');
    if (share !== undefined) bar.value = share;
    else bar.removeAttribute('value');
  }
}
