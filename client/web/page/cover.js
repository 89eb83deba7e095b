// What stands in place of the picture while there is none: connecting, loading, the entrance where a token is asked for, a
// cloud that failed or is gone, with what to do and what else there is to look at. A lost connection leaves the picture in sight.

import { element } from './parameter_fields.js';
import { Pace, progressWords } from './progress.js';
import { strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const words = strings.cover;
const nameOf = (entry) => entry.title || entry.id;

/** "A", "A and B", "A and 3 more". */
const namesOf = ([first, ...others]) =>
  (others.length === 0 ? nameOf(first) : words.andMore(nameOf(first), others.length, nameOf(others[0])));

/** A sentence ends with a full stop. */
const sentence = (text) => (/[.!?]$/.test(text) ? text : `${text}.`);

function lockedCover({ refused, guest }) {
  const { token } = strings;
  if (guest) return { title: token.guest, detail: token.guestDetail, token: true };
  return { title: location.host, detail: refused ? token.refused : token.detail, token: true };
}

function failedCover({ entries, clouds, asked }) {
  const reasons = entries.map((entry) => ({ name: nameOf(entry), error: entry.error ? sentence(entry.error) : words.failedUnknown }));
  const [first] = reasons;
  if (entries.length > 1) return { title: words.failedAll, reasons, retry: words.retry };
  return { title: words.failed(first.name), detail: first.error, advice: words.failedAdvice, retry: words.retry, others: asked ? clouds : [] };
}

function goneCover({ cloud, clouds, pending, shown }) {
  return {
    title: shown ? words.gone(nameOf(shown)) : words.unknown(cloud),
    detail: shown ? words.goneDetail : words.unknownDetail,
    retry: words.retry,
    others: [...clouds, ...pending],
  };
}

function loadingCover({ entries, clouds }, pace) {
  const { step, share, percent, left } = progressWords(entries[0], pace);
  return {
    title: words.loading(namesOf(entries)), detail: [step, percent, left].filter(Boolean).join(' · '), progress: share ?? null, others: clouds,
  };
}

/** What a state of session.js looks like; undefined where the picture is to be seen. */
function coverOf(state, pace) {
  switch (state.kind) {
    case 'connecting': return { title: words.connecting };
    case 'locked': return lockedCover(state);
    case 'failed': return failedCover(state);
    case 'gone': return goneCover(state);
    case 'empty': return { title: words.empty, detail: words.emptyDetail, code: 'scancast serve town.las' };
    case 'loading': return loadingCover(state, pace);
    default: return undefined;
  }
}

export class Cover {
  #on;
  #countdown;
  #pace = new Pace();
  #listed = '';

  /** `on` has retry(), token(text, remember) and cloud(id): one of those that are listed was chosen. */
  constructor(on) {
    this.#on = on;
    find('cover-token').addEventListener('submit', (event) => {
      event.preventDefault();
      const field = find('token');
      on.token(field.value, find('token-remember').checked);
      field.value = '';
      this.#reveal(false);
    });
    find('token-reveal').addEventListener('click', () => this.#reveal(find('token').type === 'password'));
    find('cover-retry').addEventListener('click', () => on.retry());
  }

  /**
   * `state` as session.js reports it; `shown`: the cloud whose picture is on the canvas, undefined for none.
   */
  show(state, shown) {
    clearInterval(this.#countdown);
    const cover = find('cover');
    cover.dataset.kind = state.kind;
    const lost = state.kind === 'lost';
    cover.classList.toggle('over-picture', shown !== undefined && lost);
    find('picture').classList.toggle('stale', lost);
    if (lost) this.#lost(state);
    else this.#fill(coverOf(state.kind === 'gone' && shown?.id === state.cloud ? { ...state, shown } : state, this.#pace));
  }

  #fill(cover) {
    find('cover').hidden = cover === undefined;
    if (!cover) return;
    const set = (id, text) => {
      const node = find(id);
      // Screen readers hear every change of a status: only real ones.
      if (node.textContent !== (text ?? '')) node.textContent = text ?? '';
      node.hidden = !text;
    };
    set('cover-title', cover.title);
    set('cover-detail', cover.detail);
    set('cover-advice', cover.advice);
    set('cover-code', cover.code);
    find('cover-retry').hidden = !cover.retry;
    if (cover.retry) set('cover-retry', cover.retry);
    find('cover-reasons').hidden = !cover.reasons;
    find('cover-reasons').replaceChildren(
      ...(cover.reasons ?? []).flatMap(({ name, error }) => [element('dt', { textContent: name }), element('dd', { textContent: error })]),
    );
    this.#offer(cover.others ?? []);
    this.#askForToken(cover.token === true);
    const progress = find('cover-progress');
    progress.hidden = cover.progress === undefined;
    if (typeof cover.progress === 'number') progress.value = cover.progress;
    else progress.removeAttribute('value'); // busy, but nobody knows how long
  }

  /** What else there is to look at. */
  #offer(entries) {
    find('cover-others').hidden = entries.length === 0;
    const text = JSON.stringify(entries.map(({ id, title, state }) => [id, title, state]));
    if (text === this.#listed) return; // not under the hands of somebody who is choosing
    this.#listed = text;
    const { loading, failed } = strings.panel;
    const label = { loading, failed };
    find('cover-list').replaceChildren(...entries.map((entry) => {
      const button = element('button', { type: 'button', textContent: label[entry.state]?.(nameOf(entry)) ?? nameOf(entry) });
      button.dataset.cloud = entry.id;
      button.addEventListener('click', () => this.#on.cloud(entry.id));
      return element('li', {}, button);
    }));
  }

  #askForToken(asks) {
    const form = find('cover-token');
    if (form.hidden === !asks) return;
    form.hidden = !asks;
    if (asks) find('token').focus();
  }

  #reveal(shows) {
    find('token').type = shows ? 'text' : 'password';
    find('token-reveal').textContent = shows ? strings.token.hide : strings.token.show;
    find('token-reveal').setAttribute('aria-label', shows ? strings.token.hideLabel : strings.token.showLabel);
  }

  #lost(state) {
    const show = () => {
      const seconds = Math.max(0, Math.ceil((state.at - performance.now()) / 1000));
      const again = seconds > 1 ? words.againIn(seconds) : words.again;
      this.#fill({ title: words.lost, detail: [state.detail, again].filter(Boolean).join(' '), retry: words.retryNow });
    };
    show();
    this.#countdown = setInterval(show, 500);
  }
}
