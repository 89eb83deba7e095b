// Exports: the dialog in which somebody says which points he wants and how, how many they are, and the file while it comes. What is sent is what
// `scancast export` writes (docs/export.md); the page keeps none of it (saving.js).

import { element } from '../page/parameter_fields.js';
import { putCard } from '../page/lazy_tools.js';
import { counted, strings } from '../page/strings.js';
import { exporting as words } from '../page/strings/export.js';
import { postSoon, soon } from './asking.js';
import { card } from './card.js';
import { Maps } from './maps.js';
import { countIn, fileName, limitsOf, regionOf } from './region.js';
import { sizeText } from './sizes.js';
import { chooseTarget, mostInBlob, saveAnswer, writesFiles } from './saving.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const countAfterMs = 250;
const headBytes = 4096;

export class Exporting {
  #viewer;
  #page;
  #maps;
  #counting; // AbortController of the question how many they are
  #saving; // of the file that comes
  #timer;
  #known; // { points, bytes } of what is chosen
  #outlines = []; // { name, points } of the areas that have been measured

  /** `page`: { overlays, outlines(), the measured areas: [{ name, points }] } */
  constructor(viewer, page) {
    this.#viewer = viewer;
    this.#page = page;
    putCard(card, words);
    find('export-format').append(...Object.entries(words.formats).map(([value, textContent]) => element('option', { value, textContent })));
    this.#maps = new Maps(viewer, (path, what) => {
      const { server, cloud } = viewer;
      this.#saveFile(fileName(undefined, cloud.id, what, 'tif'), 'tif', (signal) => soon(() => server.ask(path, { signal }), signal), undefined);
    });
    find('export-points').addEventListener('change', () => this.#changed());
    find('exporting').addEventListener('close', () => this.#stop());
    find('export-save').addEventListener('click', () => this.#save());
    find('export-stop').addEventListener('click', () => this.#saving?.abort());
    find('export-close').addEventListener('click', () => find('exporting').close());
    find('exporting').addEventListener('cancel', (event) => {
      if (!this.#saving) return;
      event.preventDefault(); // Escape ends what is being saved first
      this.#saving.abort();
    });
  }

  open() {
    if (!this.#viewer.cloud || find('exporting').open) return;
    const { classes, shapes, filter } = limitsOf(this.#viewer.view);
    this.#outlines = this.#page.outlines();
    const radio = (value) => find('exporting').querySelector(`[value=${value}]`);
    for (const [value, isThere, why] of [['shapes', shapes, words.noShapes], ['polygon', this.#outlines.length > 0, words.noPolygon]]) {
      radio(value).disabled = !isThere;
      radio(value).parentElement.title = isThere ? '' : why;
    }
    radio(shapes ? 'shapes' : 'all').checked = true;
    find('export-outline').replaceChildren(...this.#outlines.map(({ name }, i) => element('option', { value: String(i), textContent: name })).reverse());
    find('export-classes-row').hidden = !classes;
    find('export-filter-row').hidden = !filter;
    find('export-state').textContent = '';
    const { mayExport } = this.#viewer.server.access;
    find('export-guest').hidden = mayExport;
    find('export-points').hidden = !mayExport;
    this.#maps.show();
    find('exporting').showModal();
    if (mayExport) this.#changed();
  }

  /** What is chosen, as `POST …/points` has it. */
  get #question() {
    const which = find('exporting').querySelector('[name=export-region]:checked').value;
    const region = regionOf(this.#viewer.view, {
      shapes: which === 'shapes', classes: find('export-classes').checked, filter: find('export-filter').checked, polygon: which === 'polygon' ? this.#outlines[Number(find('export-outline').value)]?.points : undefined,
    });
    return { format: find('export-format').value, ...(region ? { region } : {}), ...(find('export-normals').checked ? { normals: true } : {}) };
  }

  // ---- how many they are

  #changed() {
    const which = find('exporting').querySelector('[name=export-region]:checked').value;
    find('export-outline').hidden = which !== 'polygon';
    this.#say(''); // of what was chosen before
    this.#countSoon();
  }

  #countSoon() {
    this.#counting?.abort();
    this.#known = undefined;
    clearTimeout(this.#timer);
    find('export-count').textContent = words.counting;
    find('export-save').disabled = false;
    this.#timer = setTimeout(() => this.#count(), countAfterMs);
  }

  /** The head of a LAS or PLY file says how many there are; the rest of it is not waited for. */
  async #count() {
    if (this.#saving || !find('exporting').open) return;
    const counting = new AbortController();
    this.#counting = counting;
    const question = this.#question;
    const hasSize = ['las', 'ply'].includes(question.format);
    try {
      const response = await postSoon(this.#viewer.server, this.#viewer.cloud.id, 'points', { ...question, format: hasSize ? question.format : 'las' }, counting.signal);
      const head = await beginningOf(response, headBytes);
      if (this.#counting !== counting) return;
      const found = countIn(head);
      this.#known = found && { points: found.points, bytes: hasSize ? found.bytes : undefined };
      this.#showCount();
    } catch (/** @type {any} */ error) {
      if (this.#counting !== counting || counting.signal.aborted) return;
      const isEmpty = error.status === 422 && /no point/i.test(error.message);
      find('export-count').textContent = isEmpty ? words.empty : error.title ? error.message : strings.messages.noAnswer;
      find('export-save').disabled = isEmpty || error.status === 403 || error.status === 422;
    } finally {
      counting.abort(); // no more of it is wanted
    }
  }

  #showCount() {
    const { points, bytes } = this.#known ?? {};
    const isTooLarge = bytes > mostInBlob && !writesFiles();
    find('export-count').textContent = points === undefined ? words.uncounted : words.count(counted(points, 'point'), bytes && sizeText(bytes));
    find('export-save').disabled = isTooLarge;
    if (isTooLarge) find('export-state').textContent = words.tooLarge(sizeText(mostInBlob));
  }

  // ---- the file

  #stop() {
    clearTimeout(this.#timer);
    this.#counting?.abort();
    this.#saving?.abort();
  }

  #say(text) { find('export-state').textContent = text; }

  #busy(isBusy) {
    find('export-save').hidden = isBusy;
    find('export-stop').hidden = !isBusy;
    find('export-progress').hidden = !isBusy;
    find('export-progress').removeAttribute('value'); // nobody knows how far it is, at first
    for (const field of find('exporting').querySelectorAll('fieldset, select, input[type=checkbox], #raster-save')) field.disabled = isBusy;
    if (isBusy) find('export-stop').focus();
    else if (find('exporting').open) find(find('export-points').hidden ? 'raster-save' : 'export-save').focus();
  }

  #save() {
    const question = this.#question;
    const { cloud, server } = this.#viewer;
    const name = fileName(undefined, cloud.id, question.region ? 'part' : '', question.format);
    return this.#saveFile(name, question.format, (signal) => postSoon(server, cloud.id, 'points', question, signal), this.#known?.bytes);
  }

  /** What `ask(signal)` is answered, of which so many bytes are expected, into a file of that name. */
  async #saveFile(name, format, ask, expected) {
    if (this.#saving) return;
    const saving = new AbortController();
    this.#saving = saving;
    this.#counting?.abort();
    try {
      const target = await chooseTarget(name, format);
      if (!target) return;
      this.#busy(true);
      this.#say(words.waiting);
      let shown = 0;
      const { response, bytes } = await saveAnswer(() => ask(saving.signal), target, (done) => {
        if (performance.now() - shown < 120) return;
        shown = performance.now();
        this.#say(words.saving(sizeText(done), expected && sizeText(expected)));
        if (expected) find('export-progress').value = Math.min(1, done / expected);
      }, saving.signal);
      const losses = response.headers.get('Scancast-Losses');
      this.#say([words.saved(target.name, sizeText(bytes)), losses && words.losses(losses.replace(/^"|"$/g, '').replaceAll('", "', '; '))].filter(Boolean).join(' '));
    } catch (/** @type {any} */ error) {
      if (saving.signal.aborted) this.#say(words.stopped);
      else if (error instanceof RangeError) this.#say(words.tooLarge(sizeText(mostInBlob)));
      else this.#say(error.title ? `${error.title}. ${error.message}` : words.brokenOff);
    } finally {
      this.#saving = undefined;
      this.#busy(false);
      if (!this.#known && find('exporting').open && !find('export-points').hidden) this.#countSoon(); // it gave way to the file
    }
  }
}

/** The first bytes of an answer's body, at most `most` or a chunk more. */
async function beginningOf(response, most) {
  const reader = response.body.getReader();
  const parts = [];
  let length = 0;
  while (length < most) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    length += value.length;
  }
  reader.cancel().catch(() => {});
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}
