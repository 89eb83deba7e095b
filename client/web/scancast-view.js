// <scancast-view>: a point cloud in any web page. This file is all that a page names; what it needs comes from beside it.
//
//   <script type="module" src="https://scans.example.org/scancast-view.js"></script>
//   <scancast-view cloud="town" view="eye=10,-60,40&amp;target=0,0,5" style="height: 480px"></scancast-view>
//
// The server lets pages of other websites in that it has been told of (serve --allowed-origin https://www.example.com).
//
// Attributes
//   src       the server's address; without it, that of the server this file came from
//   cloud     the id of a cloud; without it, the server's first one
//   view      a view in the words of the protocol, as behind the # of the page's links
//   controls  what dragging does: "orbit" (without it), "look" around, or "none": nothing can be moved by hand
//   manual    whoever wrote this does the rest: nothing is connected before viewer.start(), and nothing is said over the
//             picture. The Scancast page is made like that; a <canvas> inside the element is the one that is drawn on
//
// Properties and methods
//   viewer    everything else (view/viewer.js), such as viewer.changeStyle({ color: 'elevation' }), viewer.camera, viewer.catalog
//   cloud, view, controls   as the attributes; reading `view` gives the view that is shown now
//   token     an access token for the server; it can be set only, and is kept for this tab
//   fit()     all of the cloud; showStandardView('top'), 'front', 'side', …
//   snapshot({ width, height, format })   a picture in full quality, as a Blob
//   pick(x, y)   the scan's point under a pixel of the element, or null
//
// Events: `connection`, `cloudchange`, `viewchange`, `frame` and `problem`, with a `detail` as view/viewer.js tells it.

import { Server } from './connection/server.js';
import { parseHash, printHash } from './view/view_hash.js';
import { Viewer } from './view/viewer.js';

const ownServer = new URL('/', import.meta.url).href;

const look = `
  :host { display: block; position: relative; overflow: hidden; min-height: 120px; }
  :host([hidden]) { display: none; }
  canvas { position: absolute; inset: 0; display: block; width: 100%; height: 100%; cursor: grab; touch-action: none;
    background: linear-gradient(#3a424e, #16191e); outline-offset: -3px; }
  canvas.grabbed { cursor: grabbing; }
  :host([controls="none"]) canvas { cursor: auto; touch-action: auto; }
  p { position: absolute; left: 50%; bottom: 16px; margin: 0; padding: 8px 14px; max-width: 80%; transform: translateX(-50%);
    border-radius: 10px; background: #fffffff2; color: #17202a; font: 14px/1.4 system-ui, sans-serif; }
  p[hidden] { display: none; }
`;

/**
 * What is said over the picture while it is not what was asked for. Pure.
 * @param {{ kind: string, [more: string]: any }} now
 * @returns {string}
 */
export function wordsFor(now) {
  const nameOf = ({ title, id }) => title || id;
  switch (now.kind) {
    case 'open': return '';
    case 'connecting': return 'Connecting…';
    case 'loading': return `Loading ${now.entries.map(nameOf).join(', ')}…`;
    case 'failed': return now.entries.map((entry) => `${nameOf(entry)} could not be loaded. ${entry.error ?? 'The server’s log says why.'}`).join(' ');
    case 'gone': return `This server has no scan named ${now.cloud}.`;
    case 'empty': return 'This server has no scan to show.';
    case 'locked': return now.refused ? 'The access token was not accepted.' : 'This scan needs an access token.';
    default: return [now.detail, 'Trying again…'].filter(Boolean).join(' ');
  }
}

export class ScancastView extends HTMLElement {
  static observedAttributes = ['cloud', 'view', 'controls'];

  #viewer;
  #says;
  #started = false;
  #again; // the view that was shown when it was taken out of the document

  /**
   * Made when it is first asked for: by then `src` has been read.
   * @returns {Viewer}
   */
  get viewer() {
    if (!this.#viewer) this.#begin();
    return this.#viewer;
  }

  #begin() {
    const server = new Server(new URL(this.getAttribute('src') || ownServer, document.baseURI).href);
    const own = /** @type {HTMLCanvasElement | null} */ (this.querySelector(':scope > canvas'));
    const canvas = own ?? document.createElement('canvas');
    const shadow = this.attachShadow({ mode: 'open' });
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(look);
    shadow.adoptedStyleSheets = [sheet];
    this.#says = document.createElement('p');
    this.#says.setAttribute('role', 'status');
    this.#says.part.add('message');
    this.#says.hidden = true;
    if (own) shadow.append(document.createElement('slot'));
    else {
      canvas.tabIndex = 0;
      canvas.setAttribute('role', 'img');
      canvas.part.add('picture');
      shadow.append(canvas, this.#says);
    }
    // Keys of a page that has more on it are the view's only while it has the focus.
    this.#viewer = new Viewer(canvas, server, own ? globalThis : canvas);
    this.#obeyControls();
    const tell = (from, to) => this.#viewer.addEventListener(from, ({ detail }) => this.dispatchEvent(new CustomEvent(to, { detail })));
    for (const name of ['connection', 'frame', 'problem']) tell(name, name);
    tell('cloud', 'cloudchange');
    tell('view', 'viewchange');
    this.#viewer.addEventListener('connection', ({ detail }) => this.#say(wordsFor(detail)));
    this.#viewer.addEventListener('cloud', ({ detail }) => canvas.setAttribute('aria-label', `Point cloud: ${detail.title || detail.id}`));
  }

  connectedCallback() {
    if (this.hasAttribute('manual') || this.#started) return;
    this.#started = true;
    const { viewer } = this;
    const words = this.#again ?? this.getAttribute('view') ?? '';
    const link = parseHash(`#${words}`);
    viewer.start({ ...link, cloud: link?.cloud ?? this.getAttribute('cloud') ?? undefined });
  }

  /** Gone from the document, and not just moved within it: the connection ends, and where it was is kept for when it comes back. */
  disconnectedCallback() {
    queueMicrotask(() => {
      if (this.isConnected || !this.#started) return;
      this.#started = false;
      this.#again = this.view;
      this.#viewer.stop();
    });
  }

  attributeChangedCallback(name, _, value) {
    if (!this.#viewer) return;
    if (name === 'controls') this.#obeyControls();
    else if (name === 'cloud' && value !== null) this.#viewer.open(value);
    else if (name === 'view' && value !== null) this.view = value;
  }

  #obeyControls() {
    this.#viewer.steerable = this.controls !== 'none';
    this.#viewer.looksAround = this.controls === 'look';
  }

  #say(words) {
    this.#says.hidden = words === '' || this.hasAttribute('manual');
    if (this.#says.textContent !== words) this.#says.textContent = words;
  }

  /** @type {string} */
  get cloud() {
    return this.#viewer?.cloud?.id ?? this.getAttribute('cloud') ?? '';
  }

  set cloud(id) {
    this.setAttribute('cloud', id);
  }

  /** @type {string} */
  get controls() {
    return this.getAttribute('controls') ?? 'orbit';
  }

  set controls(value) {
    this.setAttribute('controls', value);
  }

  /** The view that is shown, in the words of the protocol. */
  get view() {
    if (!this.#viewer?.cloud) return this.getAttribute('view') ?? '';
    return printHash(this.#viewer.cloud.id, this.#viewer.view, this.#viewer.camera?.upAxis).slice(1);
  }

  set view(words) {
    const link = parseHash(`#${words}`);
    if (link) this.viewer.restore(link);
  }

  /** @param {string} token */
  set token(token) {
    this.viewer.unlock(token);
  }

  fit() {
    this.viewer.showStandardView('fit');
  }

  /** @param {'fit' | 'first' | 'top' | 'front' | 'side' | 'back' | 'left' | 'bottom'} name */
  showStandardView(name) {
    this.viewer.showStandardView(name);
  }

  /**
   * A picture of the view that is shown, in full quality. Rejects with what the server refuses with, which has a `title`, a
   * `status` and a `message`.
   * @param {{ width?: number, height?: number, format?: 'png' | 'jpg' }} [wanted] pixels; without them, those of the element
   * @returns {Promise<Blob>}
   */
  snapshot({ width = this.viewer.pictureSize.width, height = this.viewer.pictureSize.height, format = 'png' } = {}) {
    return this.viewer.server.snapshot(this.cloud, this.viewer.view, { width, height }, { format });
  }

  /**
   * The point of the scan that is seen there, as the protocol has it ("A picked point"); null where there is none.
   * @param {number} x CSS pixels from the element's left edge
   * @param {number} y and from its upper one
   * @returns {Promise<{ position: [number, number, number], depth: number, distance: number, [more: string]: any } | null>}
   */
  pick(x, y) {
    return this.viewer.pickAt({ x, y });
  }
}

if (!customElements.get('scancast-view')) customElements.define('scancast-view', ScancastView);
