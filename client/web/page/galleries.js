// Galleries of small pictures: the methods' in the panel, and the views that the server found to show most of the scan, beside
// the rail. Both show names at once and pictures as they come (thumbnails.js).

import { element } from './parameter_fields.js';
import { strings } from './strings.js';
import { middleOf, Thumbnails, thumbnailUrl } from './thumbnails.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

function put(place, address) {
  if (!place?.isConnected) return;
  const image = element('img', { src: address, alt: '', draggable: false });
  place.replaceChildren(image);
}

export class Galleries {
  #viewer;
  #controls;
  #thumbnails;
  #open = new Set();
  #others = () => /** @type {{ changes: any, place: Element }[]} */ ([]); // saved views, once there are such

  /** `controls()` tells the methods and where their pictures go. */
  constructor(viewer, controls) {
    this.#viewer = viewer;
    this.#thumbnails = new Thumbnails(viewer.server);
    this.#controls = controls;
    const popover = find('views-gallery');
    popover.addEventListener('toggle', ({ newState }) => {
      if (newState === 'open') this.#fillViews();
      this.show('views', newState === 'open');
    });
    viewer.addEventListener('camera', () => this.#thumbnails.moved(() => this.#ask()));
    viewer.addEventListener('cloud', () => {
      if (this.#open.has('views')) this.#fillViews();
      this.#ask();
    });
    viewer.addEventListener('view', ({ detail }) => {
      if (detail.by === 'style') this.#ask();
    });
  }

  /** `pictures()`: [{ changes, place }], what else the gallery of views has pictures of: how that differs from the view, and where it goes. */
  also(pictures) {
    this.#others = pictures;
  }

  /** What is to be seen there is something else. */
  renew() {
    this.#ask();
  }

  /** 'methods' or 'views' is open now, or is not any more. */
  show(gallery, open) {
    if (open) this.#open.add(gallery);
    else this.#open.delete(gallery);
    this.#ask();
  }

  get #views() {
    return this.#viewer.cloud?.look?.views ?? [];
  }

  #fillViews() {
    const buttons = this.#views.map((view) => {
      const button = element('button', { type: 'button', className: 'choice' },
        element('span', { className: 'thumbnail' }), element('span', { className: 'name', textContent: capital(view.name ?? '') }));
      button.addEventListener('click', () => this.#viewer.showView(view));
      return button;
    });
    find('views-list').replaceChildren(...(buttons.length > 0 ? buttons : [element('p', { className: 'note', textContent: strings.views.none })]));
  }

  #ask() {
    const { cloud, view } = this.#viewer;
    const wanted = [];
    const add = (changes, place) => {
      const url = thumbnailUrl(cloud.id, { ...view, ...changes });
      wanted.push({ url, key: `${cloud.revision} ${url}`, show: (address) => put(place, address) });
    };
    if (cloud && this.#open.has('views')) {
      const places = find('views-list').querySelectorAll('.thumbnail');
      this.#views.forEach(({ camera }, i) => add({ camera }, places[i]));
      for (const { changes, place } of this.#others()) add(changes, place);
    }
    if (cloud && view.camera && this.#open.has('methods')) {
      const camera = middleOf(view.camera, this.#viewer.pictureSize.height);
      for (const { method, place } of this.#controls().methodPictures) {
        add({ method, camera, ...(method === view.method ? {} : { param: {} }) }, place);
      }
    }
    this.#thumbnails.want(wanted);
  }
}
