// What lies over the picture now and then: the cover while there is nothing to see, the line about a lost connection,
// a message about something refused, and the help.

import { keyTable } from '../view/keys.js';
import { element } from './parameter_fields.js';

const find = (id) => document.getElementById(id);
const toastMs = 9000;

function coverWords(state) {
  if (state.kind === 'connecting') return { title: 'Connecting…' };
  if (state.kind === 'locked') {
    if (state.guest) {
      const detail = 'Ask whoever sent it for another one. Whoever has an access token can look with that.';
      return { title: 'This link is not good any more', detail, token: true };
    }
    const who = 'Whoever runs this server has it. It is kept for this tab only.';
    return { title: 'Access token', detail: state.refused ? `That was not it. ${who}` : who, token: true };
  }
  if (state.kind === 'empty') {
    return {
      title: 'No cloud yet',
      detail: 'The server runs, but it has no scan to show. Start it with one:',
      code: 'scancast serve town.las',
    };
  }
  if (state.kind === 'failed') {
    const names = state.entries.map((entry) => entry.title || entry.id).join(', ');
    return { title: 'Nothing could be loaded', detail: `The server could not read ${names}. Its log says why.` };
  }
  if (state.kind === 'loading') {
    const [first, ...others] = state.entries;
    const more = others.length > 0 ? ` and ${others.length} more` : '';
    const stage = first.stage ? `${first.stage.charAt(0).toUpperCase()}${first.stage.slice(1)}` : 'Reading the scan';
    return { title: `Loading ${first.title || first.id}${more}`, detail: stage, progress: first.progress ?? null };
  }
  return undefined;
}

export class Overlays {
  #toastTimer;
  #countdown;

  constructor(onRetry, onToken) {
    find('cover-token').addEventListener('submit', (event) => {
      event.preventDefault();
      const field = find('token');
      onToken(field.value);
      field.value = '';
    });
    find('cover-retry').addEventListener('click', onRetry);
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
    else help.showModal();
  }

  /** `state` as session.js reports it; `hasPicture`: something is on the canvas that is worth leaving in sight. */
  connection(state, hasPicture) {
    clearInterval(this.#countdown);
    const cover = find('cover');
    cover.dataset.kind = state.kind;
    cover.classList.toggle('over-picture', hasPicture && state.kind === 'lost');
    find('picture').classList.toggle('stale', state.kind === 'lost');
    if (state.kind === 'lost') this.#lost(state);
    else this.#cover(coverWords(state));
  }

  #cover(words) {
    find('cover').hidden = words === undefined;
    if (!words) return;
    const set = (id, text) => {
      const node = find(id);
      if (node.textContent !== (text ?? '')) node.textContent = text ?? '';
      return node;
    };
    set('cover-title', words.title);
    set('cover-detail', words.detail);
    set('cover-code', words.code).hidden = !words.code;
    find('cover-retry').hidden = !words.retry;
    this.#askForToken(words.token);
    const progress = find('cover-progress');
    progress.hidden = words.progress === undefined;
    if (typeof words.progress === 'number') progress.value = words.progress;
    else progress.removeAttribute('value'); // busy, but nobody knows how long
  }

  #askForToken(asks) {
    const form = find('cover-token');
    if (form.hidden === !asks) return;
    form.hidden = !asks;
    if (asks) find('token').focus();
  }

  #lost(state) {
    const show = () => {
      const seconds = Math.max(0, Math.ceil((state.at - performance.now()) / 1000));
      const again = seconds > 1 ? `Trying again in ${seconds} seconds.` : 'Trying again…';
      this.#cover({ title: 'Connection lost', detail: [state.detail, again].filter(Boolean).join(' '), retry: true });
    };
    show();
    this.#countdown = setInterval(show, 500);
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
