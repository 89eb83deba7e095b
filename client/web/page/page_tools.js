// The tools that come when they are first used, and what they need of the page: which scan is shown, what an address says of them, whose the
// hand on the picture is. A tool more is a row here, and a place in tools.js.

import { acceptDrops, keepsSome, measuresIn } from '../measure/beginning.js';
import { Reading } from '../measure/reading.js';
import { knowsColumns } from './columns.js';
import { LazyPart, LazyTools } from './lazy_tools.js';
import { strings } from './strings.js';

const words = strings.tools;

/** Whether a server cuts by shapes, and shows several clouds: older ones do not have those words. */
const [knowsClips, knowsTogether] = ['clips', 'with'].map((word) => (cloud) => Object.hasOwn(cloud?.view ?? {}, word));

export class PageTools {
  #viewer;
  #lazy;
  #rest; // of the tools: those that only some servers and scans have
  #arrived = ''; // measures of an address, until measuring has read them
  #compared = ''; // the same of two sides
  #savedViews;
  #picture;
  #photos;

  /**
   * `page`: { overlays (messages), hash() (the view as an address says it), changed() (hears that the address has something new to say), galleries(),
   * onPicture(), chosen (which method is drawn by) }
   */
  constructor(viewer, rail, page) {
    this.#lazy = new LazyTools(rail, page.overlays);
    const reading = new Reading(viewer);
    const project = async () => (await this.#lazy.get('measure')).keeping;
    this.#lazy.add({
      id: 'measure', label: words.measure, tip: words.measureTip, icon: 'measure', key: 'm', styles: ['card.css', 'measure.css'],
      load: async (active) => {
        const measuring = new (await import('../measure/measuring.js')).Measuring(viewer, { ...page, reading, active });
        const { notes } = measuring.keeping;
        const show = () => notes.list.length > 0 && this.#lazy.get('annotate'); // they are to be seen
        notes.addEventListener('change', show);
        queueMicrotask(show);
        return measuring;
      },
    });
    this.#lazy.add({
      id: 'annotate', label: words.annotate, tip: words.annotateTip, icon: 'annotate', key: 'i', styles: ['card.css', 'measure.css', 'annotate.css'],
      load: async (active) => {
        const [{ Annotating }, keeping] = await Promise.all([import('../annotate/annotating.js'), project()]);
        return new Annotating(viewer, { overlays: page.overlays, reading, keeping, active });
      },
    });
    this.#lazy.add({
      id: 'compare', label: words.compare, tip: words.compareTip, icon: 'compare', key: 'k', styles: ['card.css', 'compare.css'],
      load: async (active) => new (await import('../compare/comparing.js')).Comparing(viewer, {
        overlays: page.overlays, changed: page.changed, active, title: (method) => page.chosen.title(method),
      }),
    });
    this.#savedViews = new LazyPart({
      styles: ['views.css'],
      load: async () => {
        const [{ SavedViews }, keeping] = await Promise.all([import('../views/saved_views.js'), project()]);
        return new SavedViews(viewer, { overlays: page.overlays, hash: page.hash, keeping, galleries: page.galleries() });
      },
    }, page.overlays);
    this.#picture = new LazyPart({
      styles: ['picture.css'],
      load: async () => new (await import('../picture/picture_dialog.js')).PictureDialog(viewer, { overlays: page.overlays, onPicture: page.onPicture(), chosen: page.chosen }),
    }, page.overlays);
    this.#rest = [
      { offered: knowsClips, tool: {
        id: 'clip', label: words.clip, tip: words.clipTip, icon: 'clip', key: 'x', styles: ['card.css', 'clip.css'],
        load: async (active) => new (await import('../clip/clipping.js')).Clipping(viewer, active),
      } },
      { offered: knowsColumns, tool: {
        id: 'filter', label: words.filter, tip: words.filterTip, icon: 'filter', key: 'b', styles: ['card.css', 'filter.css'],
        load: async (active) => new (await import('../filter/filtering.js')).Filtering(viewer, { ...page, active }),
      } },
      { offered: knowsTogether, tool: {
        id: 'together', label: words.together, tip: words.togetherTip, icon: 'together', key: 'u', styles: ['card.css', 'together.css'],
        load: async (active) => new (await import('../together/together.js')).Together(viewer, active),
      } },
    ];
    this.#lazy.add({
      id: 'profile', label: words.profile, tip: words.profileTip, icon: 'profile', key: 't', styles: ['card.css', 'measure.css', 'profile.css'],
      load: async (active) => new (await import('../profile/profiling.js')).Profiling(viewer, { ...page, reading, active }),
    });
    const exporting = new LazyPart({
      styles: ['export.css'],
      load: async () => new (await import('../export/exporting.js')).Exporting(viewer, { ...page, outlines: () => this.#lazy.made('measure')?.outlines ?? [] }),
    }, page.overlays);
    rail.register({ id: 'export', label: words.export, tip: words.exportTip, icon: 'export', activate: async () => (await exporting.get())?.open() });
    this.#photos = new LazyPart({
      styles: ['photos.css'],
      load: async () => new (await import('./photos.js')).Photos(viewer.server, (place) => viewer.goToPlace(place), () => viewer.pictureSize),
    }, page.overlays);
    this.#viewer = viewer;
    acceptDrops(async (file) => (await this.#lazy.get('measure'))?.open(file));
  }

  /** That scan is shown from now on. */
  show(cloud) {
    for (const { offered, tool } of this.#rest) if (!this.#lazy.has(tool.id) && offered(cloud)) this.#lazy.add(tool);
    if (!this.#lazy.made('measure') && keepsSome(cloud)) this.#lazy.get('measure');
    this.#withPhotos((photos) => photos.show(this.#viewer.cloud));
  }

  /** Somebody goes to that scan position. */
  atStation(station) { this.#withPhotos((photos) => photos.at(station)); }

  /** Photos come with the first scan that has some. */
  async #withPhotos(use) {
    const photos = this.#photos.made ?? (this.#viewer.cloud?.photos > 0 && await this.#photos.get());
    if (photos) use(photos);
  }

  /** The gallery of views is open. */
  showViews() { this.#savedViews.get(); }

  /** Plays the tour, or ends it. */
  async playTour() { (await this.#savedViews.get())?.play(); }

  /** Ends the tour that is played. */
  stopTour() { this.#savedViews.made?.stop(); }

  /** Asks how a picture is to be saved. */
  async savePicture(button) {
    button.setAttribute('aria-busy', 'true');
    const dialog = await this.#picture.get();
    button.removeAttribute('aria-busy');
    dialog?.activate();
  }

  /** An address that somebody has been given: what it says of measures comes to those that are here. */
  async arrived(hash) {
    this.#compare(hash);
    const part = measuresIn(hash);
    if (!part) return;
    this.#arrived = part;
    const measuring = await this.#lazy.get('measure');
    measuring?.arrived(hash);
    if (measuring && this.#arrived === part) this.#arrived = '';
  }

  /** What an address says of two sides. */
  async #compare(hash) {
    if (!/[#&]compare=/.test(hash)) {
      this.#compared = '';
      this.#lazy.made('compare')?.end();
      return;
    }
    const part = hash.replace(/^#/, '').split('&').find((one) => one.startsWith('compare='));
    this.#compared = `&${part}`;
    const comparing = await this.#lazy.get('compare'); // where it cannot be loaded, the address goes on saying it
    if (!comparing || this.#compared !== `&${part}`) return;
    this.#compared = '';
    comparing.restoreHash(hash);
  }

  /** What the address says of the tools, for one that has that many characters already: '' or '&measures=…'. */
  hashPart(taken) {
    const compared = this.#compared || (this.#lazy.made('compare')?.hashPart ?? '');
    if (this.#arrived) return `&${this.#arrived}${compared}`; // nobody has read them yet
    return `${this.#lazy.made('measure')?.hashPart(taken + compared.length) ?? ''}${compared}`;
  }

  /** Whether that key opens one of them. */
  hasKey(key) { return this.#lazy.hasKey(key); }

  /** Whatever is open. */
  close() { this.#lazy.close(); }
}
