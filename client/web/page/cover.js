// What stands in place of the picture while there is none: connecting, loading, the entrance where a token is asked for, a
// cloud that failed or is gone, with what to do and what else there is to look at. A lost connection leaves the picture in sight.

import { element } from './parameter_fields.js';
import { Pace, progressWords } from './progress.js';

const find = (id) => document.getElementById(id);
const nameOf = (entry) => entry.title || entry.id;

/** "A", "A and B", "A and 3 more". */
const namesOf = ([first, ...others]) =>
  others.length === 0 ? nameOf(first) : `${nameOf(first)} and ${others.length === 1 ? nameOf(others[0]) : `${others.length} more`}`;

/** A sentence ends with a full stop. */
const sentence = (text) => (/[.!?]$/.test(text) ? text : `${text}.`);

function lockedWords({ refused, guest }) {
  if (guest) {
    return {
      title: 'This link is no longer valid',
      detail: 'Ask whoever sent it to you for a new one. If you have an access token, you can use that instead.',
      token: true,
    };
  }
  return {
    title: location.host,
    detail: refused ? 'That token was not accepted. Ask whoever runs this server.' : 'This server shows its scans to those who have an access token. Whoever runs it can give you one.',
    token: true,
  };
}

function failedWords({ entries, clouds, asked }) {
  const why = entries.map((entry) => ({ name: nameOf(entry), error: entry.error ? sentence(entry.error) : 'The server’s log says why.' }));
  const [first] = why;
  if (entries.length > 1) return { title: 'Nothing could be loaded', reasons: why, retry: 'Try again' };
  return {
    title: `${first.name} could not be loaded`,
    detail: first.error,
    advice: 'Once the file has been replaced and the server has read it again, the cloud appears here by itself.',
    retry: 'Try again',
    others: asked ? clouds : [],
  };
}

function goneWords({ cloud, clouds, pending, shown }) {
  return {
    title: shown ? `${nameOf(shown)} is no longer here` : `There is no cloud named ${cloud}`,
    detail: shown
      ? 'The server has removed it, or can no longer read it. If it comes back, it appears here by itself.'
      : 'The server that this link leads to does not have it. It may have been removed, renamed, or not been added yet; when it is there, it appears by itself.',
    retry: 'Try again',
    others: [...clouds, ...pending],
  };
}

function coverWords(state, pace) {
  if (state.kind === 'connecting') return { title: 'Connecting…' };
  if (state.kind === 'locked') return lockedWords(state);
  if (state.kind === 'failed') return failedWords(state);
  if (state.kind === 'gone') return goneWords(state);
  if (state.kind === 'empty') {
    return {
      title: 'No cloud yet',
      detail: 'The server is running, but it has no scan to show. Start it with one:',
      code: 'scancast serve town.las',
    };
  }
  if (state.kind === 'loading') {
    const [first] = state.entries;
    const { step, share, percent, left } = progressWords(first, pace);
    return {
      title: `Loading ${namesOf(state.entries)}`,
      detail: [step, percent, left].filter(Boolean).join(' · '),
      progress: share ?? null,
      others: state.clouds,
    };
  }
  return undefined;
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
    else this.#fill(coverWords(state.kind === 'gone' && shown?.id === state.cloud ? { ...state, shown } : state, this.#pace));
  }

  #fill(words) {
    find('cover').hidden = words === undefined;
    if (!words) return;
    const set = (id, text) => {
      const node = find(id);
      // Screen readers hear every change of a status: only real ones.
      if (node.textContent !== (text ?? '')) node.textContent = text ?? '';
      node.hidden = !text;
    };
    set('cover-title', words.title);
    set('cover-detail', words.detail);
    set('cover-advice', words.advice);
    set('cover-code', words.code);
    find('cover-retry').hidden = !words.retry;
    if (words.retry) set('cover-retry', words.retry);
    find('cover-reasons').hidden = !words.reasons;
    find('cover-reasons').replaceChildren(
      ...(words.reasons ?? []).flatMap(({ name, error }) => [element('dt', { textContent: name }), element('dd', { textContent: error })]),
    );
    this.#offer(words.others ?? []);
    this.#askForToken(words.token === true);
    const progress = find('cover-progress');
    progress.hidden = words.progress === undefined;
    if (typeof words.progress === 'number') progress.value = words.progress;
    else progress.removeAttribute('value'); // busy, but nobody knows how long
  }

  /** What else there is to look at. */
  #offer(entries) {
    find('cover-others').hidden = entries.length === 0;
    const text = JSON.stringify(entries.map(({ id, title, state }) => [id, title, state]));
    if (text === this.#listed) return; // not under the hands of somebody who is choosing
    this.#listed = text;
    const notes = { loading: ' (loading…)', failed: ' (could not be loaded)' };
    find('cover-list').replaceChildren(...entries.map((entry) => {
      const button = element('button', { type: 'button', textContent: nameOf(entry) + (notes[entry.state] ?? '') });
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
    find('token-reveal').textContent = shows ? 'Hide' : 'Show';
    find('token-reveal').setAttribute('aria-label', `${shows ? 'Hide' : 'Show'} the token`);
  }

  #lost(state) {
    const show = () => {
      const seconds = Math.max(0, Math.ceil((state.at - performance.now()) / 1000));
      const again = seconds > 1 ? `Trying again in ${seconds} seconds.` : 'Trying again…';
      this.#fill({ title: 'Connection lost', detail: [state.detail, again].filter(Boolean).join(' '), retry: 'Try now' });
    };
    show();
    this.#countdown = setInterval(show, 500);
  }
}
