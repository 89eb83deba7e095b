// Saving a picture: how large, in which format, with what of a drawing on it. The server draws it in full quality, at any size; the page puts
// scale bar, legend, north, title and attribution onto it, and hands it to the browser.

import { downloadBlob } from '../export/saving.js';
import { hasNorth } from '../page/plan/on_picture.js';
import { element } from '../page/parameter_fields.js';
import { creditLine } from '../page/scan_facts.js';
import { fillStrings, strings } from '../page/strings.js';
import { picture as words } from '../page/strings/picture.js';
import { snapshotUrl } from '../protocol/view_words.js';
import { poseOf } from '../view/pose.js';
import { mostComposed, mostSide, pictureName, presetsOf, sideOf } from './file_name.js';
import { drawFurniture, northOn, scaleOn } from './furniture.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const leastSide = 16;
const jpegQuality = 0.93;
const partNames = ['scale', 'legend', 'north', 'credit'];

const markup = `
<dialog id="picture-dialog" aria-labelledby="picture-title">
  <h2 id="picture-title" data-text="title"></h2>
  <form id="picture-form" novalidate>
    <label><span data-text="size"></span><select id="picture-preset"></select></label>
    <div class="pair">
      <label><span data-text="width"></span><input type="number" id="picture-width" step="1"></label>
      <label><span data-text="height"></span><input type="number" id="picture-height" step="1"></label>
    </div>
    <p id="picture-refusal" class="note warning" role="alert" hidden></p>
    <label><span data-text="format"></span><select id="picture-format"></select></label>
    <fieldset id="picture-parts"><legend data-text="furniture"></legend></fieldset>
    <p id="picture-note" class="note"></p>
    <p id="picture-name" class="note"></p>
    <div id="picture-progress" hidden><progress id="picture-bar"></progress><span id="picture-said" role="status"></span></div>
    <div class="buttons">
      <button type="button" id="picture-cancel"></button>
      <button id="picture-save" data-text="save"></button>
    </div>
  </form>
</dialog>
`;

/** A canvas of that size with the picture on it; undefined where this browser makes none. */
function canvasOf(bitmap) {
  const canvas = element('canvas', { width: bitmap.width, height: bitmap.height });
  const context = canvas.getContext('2d');
  if (!context) return undefined;
  context.drawImage(bitmap, 0, 0);
  // A canvas that is too large draws nothing, and says nothing.
  context.save();
  context.fillStyle = '#123456';
  context.fillRect(bitmap.width - 1, bitmap.height - 1, 1, 1);
  const [red] = context.getImageData(bitmap.width - 1, bitmap.height - 1, 1, 1).data;
  context.restore();
  if (red !== 0x12) return undefined;
  context.clearRect(bitmap.width - 1, bitmap.height - 1, 1, 1);
  context.drawImage(bitmap, bitmap.width - 1, bitmap.height - 1, 1, 1, bitmap.width - 1, bitmap.height - 1, 1, 1);
  return { canvas, context };
}

const blobOf = (canvas, format) => new Promise((done) => { canvas.toBlob(done, format === 'jpg' ? 'image/jpeg' : 'image/png', jpegQuality); });

export class PictureDialog {
  #viewer;
  #page;
  #loading; // AbortController of the picture that is on its way

  /** `page`: { overlays (messages), onPicture (what stands on the page's own picture), chosen (which method is drawn by) } */
  constructor(viewer, page) {
    this.#viewer = viewer;
    this.#page = page;
    const template = element('template', { innerHTML: markup });
    fillStrings(template.content, words);
    document.querySelector('main').append(template.content);
    for (const [value, label] of Object.entries(words.formats)) find('picture-format').append(element('option', { value, textContent: label }));
    for (const name of partNames) {
      const box = element('input', { type: 'checkbox', id: `picture-${name}`, checked: true });
      find('picture-parts').append(element('label', { className: 'check' }, box, element('span', { textContent: words.parts[name] })));
    }
    for (const id of ['picture-width', 'picture-height']) Object.assign(find(id), { min: String(leastSide), max: String(mostSide) });
    this.#connect();
  }

  /** Opens it; `styles` of it have been loaded. */
  activate() {
    if (find('picture-dialog').open || !this.#viewer.cloud) return;
    this.#fill();
    this.#waits(false);
    find('picture-dialog').showModal();
    find('picture-preset').focus();
  }

  #connect() {
    find('picture-preset').addEventListener('change', () => {
      const [, width, height] = presetsOf(this.#viewer.pictureSize).find(([name]) => name === find('picture-preset').value) ?? [];
      if (width) [find('picture-width').value, find('picture-height').value] = [String(width), String(height)];
      this.#show();
    });
    for (const id of ['picture-width', 'picture-height']) find(id).addEventListener('input', () => this.#show(true));
    for (const id of ['picture-format', ...partNames.map((name) => `picture-${name}`)]) find(id).addEventListener('change', () => this.#show());
    find('picture-form').addEventListener('submit', (event) => {
      event.preventDefault();
      if (this.#show()) this.#save();
    });
    find('picture-cancel').addEventListener('click', () => (this.#loading ? this.#loading.abort() : find('picture-dialog').close()));
    find('picture-dialog').addEventListener('cancel', (event) => { // Escape
      if (!this.#loading) return;
      event.preventDefault();
      this.#loading.abort();
    });
  }

  #fill() {
    const chosen = find('picture-preset').value || 'screen';
    const presets = presetsOf(this.#viewer.pictureSize);
    find('picture-preset').replaceChildren(...presets.map(([name, width, height]) =>
      element('option', { value: name, textContent: words.preset(words.presets[name], width, height) })), element('option', { value: 'free', textContent: words.presets.free }));
    find('picture-preset').value = chosen;
    const [, width, height] = presets.find(([name]) => name === chosen) ?? [];
    if (width) [find('picture-width').value, find('picture-height').value] = [String(width), String(height)];
    const hasNone = !hasNorth(this.#viewer.cloud);
    find('picture-north').disabled = hasNone;
    find('picture-north').parentElement.title = hasNone ? words.noNorth : '';
    this.#show();
  }

  get #size() {
    return { width: sideOf(find('picture-width').valueAsNumber), height: sideOf(find('picture-height').valueAsNumber) };
  }

  get #format() { return find('picture-format').value; }

  get #name() {
    const { cloud, view } = this.#viewer;
    return pictureName({ cloud: cloud.id, method: this.#page.chosen.method(view, cloud), ...this.#size, format: this.#format, date: new Date() });
  }

  #isPlain({ width, height }) { return width * height > mostComposed; }

  /** Says what will be saved; whether that can be. */
  #show(typed = false) {
    const { width, height } = this.#size;
    if (typed) {
      const [name] = presetsOf(this.#viewer.pictureSize).find(([, wide, high]) => wide === width && high === height) ?? ['free'];
      find('picture-preset').value = name;
    }
    const isGood = Boolean(width && height);
    find('picture-refusal').hidden = isGood;
    find('picture-refusal').textContent = isGood ? '' : words.pixels(leastSide, mostSide);
    find('picture-width').setAttribute('aria-invalid', String(!width));
    find('picture-height').setAttribute('aria-invalid', String(!height));
    const plain = isGood && this.#isPlain(this.#size);
    find('picture-parts').disabled = plain;
    find('picture-note').textContent = [plain ? words.plain : '', document.body.classList.contains('comparing') ? words.leftOnly : ''].filter(Boolean).join(' ');
    find('picture-save').disabled = !isGood;
    find('picture-name').textContent = isGood ? this.#name : '';
    return isGood;
  }

  #waits(waits, said = '') {
    for (const id of ['picture-preset', 'picture-width', 'picture-height', 'picture-format', 'picture-save']) find(id).disabled = waits;
    find('picture-parts').disabled = waits;
    find('picture-cancel').textContent = waits ? words.cancel : words.close;
    find('picture-progress').hidden = !waits;
    find('picture-said').textContent = said;
    if (waits) find('picture-bar').removeAttribute('value');
    else this.#show();
  }

  /** What is to stand on a picture of that size; as things are now, and not when the picture has come. */
  #parts(size) {
    const viewer = this.#viewer;
    const { cloud, camera, bounds, cssSize } = viewer;
    const wants = (name) => find(`picture-${name}`).checked && !find(`picture-${name}`).disabled;
    const pose = poseOf(camera, bounds, size.width / size.height);
    const depth = pose.orthographic ? undefined : viewer.surfaceAt({ x: cssSize.width / 2, y: cssSize.height / 2 })?.depth;
    const parts = {
      scale: wants('scale') ? scaleOn(pose, size, { depth, crsUnit: cloud.crsUnit }) : undefined,
      legend: wants('legend') ? this.#page.onPicture.legend : undefined,
      north: wants('north') && hasNorth(cloud) ? northOn(pose, camera.upAxis) : undefined,
      credit: wants('credit') ? { title: cloud.title || cloud.id, credit: creditLine(cloud) } : undefined,
    };
    return Object.values(parts).some(Boolean) && !this.#isPlain(size) ? parts : undefined;
  }

  async #save() {
    const { overlays } = this.#page;
    const [size, format, name] = [this.#size, this.#format, this.#name];
    const parts = this.#parts(size);
    const loading = new AbortController();
    this.#loading = loading;
    this.#waits(true, words.drawing);
    try {
      const plain = await this.#fetch(size, parts ? 'png' : format, loading.signal); // one loss is enough
      const composed = parts && (await this.#composed(plain, parts, size, format));
      loading.signal.throwIfAborted();
      const isLess = Boolean(parts && !composed);
      downloadBlob(isLess ? name.replace(/\.jpg$/, '.png') : name, composed ?? plain);
      find('picture-dialog').close();
      overlays.toast(strings.messages.pictureSaved, isLess ? words.notComposed : strings.messages.pictureSavedDetail(name, size.width, size.height), isLess ? 'problem' : 'done');
    } catch (/** @type {any} */ error) {
      if (loading.signal.aborted) find('picture-note').textContent = words.cancelled;
      else {
        const known = error.title !== undefined;
        overlays.toast(known ? error.title : strings.messages.pictureFailed, known ? (error.message === error.title ? '' : error.message) : strings.messages.noAnswer);
        find('picture-dialog').close();
      }
    } finally {
      this.#loading = undefined;
      const note = find('picture-note').textContent;
      this.#waits(false);
      if (loading.signal.aborted) find('picture-note').textContent = note;
    }
  }

  /** Tells how much of it has come: the server says nothing while it draws. */
  async #fetch({ width, height }, format, signal) {
    const { cloud, ...view } = this.#viewer.view;
    const response = await this.#viewer.server.ask(snapshotUrl(cloud, view, width, height, format), { signal, cache: 'default' });
    const all = Number(response.headers.get('Content-Length')) || 0;
    const parts = [];
    let came = 0;
    for (const reader = response.body.getReader(); ;) {
      const { done, value } = await reader.read();
      if (done) break;
      parts.push(value);
      came += value.length;
      if (all > 0) find('picture-bar').value = Math.min(1, came / all);
      find('picture-said').textContent = all > 0 ? words.coming(Math.floor((100 * came) / all)) : words.comingBytes((came / 1e6).toFixed(1));
    }
    return new Blob(parts, { type: response.headers.get('Content-Type') ?? 'image/png' });
  }

  async #composed(blob, parts, size, format) {
    find('picture-said').textContent = words.composing;
    find('picture-bar').removeAttribute('value');
    try {
      const bitmap = await createImageBitmap(blob);
      const made = canvasOf(bitmap);
      bitmap.close();
      if (!made) return undefined;
      drawFurniture(made.context, size, parts);
      return (await blobOf(made.canvas, format)) ?? undefined;
    } catch {
      return undefined; // no memory for it
    }
  }
}
