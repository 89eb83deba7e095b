// The project of a scan: its measures, notes, saved views and tours, and where they are kept: on this device for each scan, measures in the
// address, in project files, in exports. Everything comes to the lists as a whole or not at all, and whatever takes the place of what was
// there can be taken back.

import { mostNotes, pointOf } from '../annotate/notes.js';
import { measure as words } from '../page/strings/measure.js';
import { strings } from '../page/strings.js';
import { parseHash } from '../view/view_hash.js';
import { mostTours, mostViews, toursOf } from '../views/saved.js';
import { csvOf, dxfOf, geoJsonOf, hasSystem, isWgs84 } from './export.js';
import { acceptFiles, download, readProject } from './files.js';
import { parseMeasures, printMeasures } from './link.js';
import { unknownOf } from './measures.js';
import { printProject, refusalOf } from './project.js';
import { keep, recall } from './shelf.js';
import { SteppedList } from './stepped_list.js';
import { unitOf } from './units.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const { messages } = words;

export class Keeping {
  #viewer;
  #measures;
  #page;
  #cloud; // whose measures these are
  #next; // { cloud, use() } of a link or a project whose cloud is not shown yet
  #kept = {}; // what a project file said that is not this page's
  #refused = ''; // why the project cannot be kept as it is now
  #leftOut = 0; // measures for which the link had no room

  notes = new SteppedList(mostNotes);
  views = new SteppedList(mostViews);
  tours = new SteppedList(mostTours);

  /**
   * `page`: { overlays (messages), hash() (the view as an address says it), unit() and setUnit(unit) in which lengths are shown, opened(project)
   * after one was }.
   */
  constructor(viewer, measures, page) {
    this.#viewer = viewer;
    this.#measures = measures;
    this.#page = page;
    for (const list of [measures, this.notes, this.views, this.tours]) list.addEventListener('change', () => this.#keep());
    for (const list of [measures, this.notes]) list.addEventListener('change', () => this.#offer());
    this.#connectFiles();
  }

  /** The measures are of this cloud from now on; its own come from the shelf, where it is another one, and those that waited for it. */
  show(cloud) {
    const isOther = cloud.id !== this.#cloud?.id;
    this.#cloud = isOther ? undefined : cloud;
    if (isOther) {
      const known = recall(cloud);
      this.#kept = known?.project?.kept ?? {};
      const { measures = [], notes = [], views = [], tours = [] } = known?.project ?? {};
      this.#measures.begin(measures);
      this.notes.begin(notes);
      this.views.begin(views);
      this.tours.begin(toursOf(tours, this.views.list));
      if (known?.isUnreadable) this.#page.overlays.toast(messages.notRead, messages.notReadDetail);
      if (known?.isOlder && measures.length + notes.length > 0) this.#page.overlays.toast(messages.otherState, messages.otherStateDetail);
    }
    this.#cloud = cloud;
    find('export-geojson').hidden = !isWgs84(cloud) && !hasSystem(cloud);
    find('export-no-system').hidden = !find('export-geojson').hidden;
    if (!this.#next || (this.#next.cloud && this.#next.cloud !== cloud.id)) return;
    const { use } = this.#next;
    this.#next = undefined;
    use();
  }

  #soon(cloud, use) {
    this.#next = { cloud, use };
    if (this.#cloud && (!cloud || cloud === this.#cloud.id)) this.show(this.#cloud);
  }

  #keep() {
    if (!this.#cloud) return; // they have just come from there
    const hasSome = [this.#measures, this.notes, this.views, this.tours].some(({ list }) => list.length > 0) || Object.keys(this.#kept).length > 0;
    const text = hasSome ? this.#project('') : '';
    const reason = text && refusalOf(text);
    if (!reason) keep(this.#cloud, text);
    else if (reason !== this.#refused) this.#page.overlays.toast(messages.notKept, reason); // what is kept already stays
    this.#refused = reason;
  }

  // ---- the address

  /** One that somebody has been given: its measures come to those that are here. */
  arrived(hash) {
    const list = parseMeasures(hash);
    if (list.length > 0) this.#soon(parseHash(hash)?.cloud, () => this.#adopt(list));
  }

  #adopt(list) {
    for (const one of unknownOf(this.#measures.list, list)) this.#measures.add({ ...one, name: one.name || this.#measures.nameFor(words.kinds[one.kind]) });
  }

  /** '' or '&measures=…', for an address that has that many characters already. */
  hashPart(taken) {
    const { word, left } = printMeasures(this.#measures.list, words.kinds, taken);
    if (left > this.#leftOut) this.#page.overlays.toast(messages.linkFull, messages.linkFullDetail(left), 'done');
    this.#leftOut = left;
    return word && `&${word}`;
  }

  // ---- files

  #project(view) {
    const { notes: { list: notes }, views: { list: views }, tours: { list: tours } } = this;
    return printProject({ cloud: this.#cloud, view, unit: this.#page.unit(), measures: this.#measures.list, notes, views, tours, kept: this.#kept });
  }

  /** What exports are made of: measures, and notes as points. */
  get #points() { return [...this.#measures.list, ...this.notes.list.map(pointOf)]; }

  /** There is something to export, or nothing. */
  #offer() {
    for (const id of ['export-csv', 'export-dxf', 'export-geojson']) find(id).disabled = this.#points.length === 0;
  }

  /** The project as a file, to be opened again. */
  save() {
    this.#download('project.json', 'application/json', () => this.#project(this.#page.hash().replace(/^#/, '')));
  }

  /** Asks for a project file. */
  choose() {
    find('project-file').click();
  }

  #download(ending, type, text) {
    if (!this.#cloud) return;
    const name = `${this.#cloud.id}.${ending}`;
    download(name, type, text());
    this.#page.overlays.toast(messages.saved, name, 'done');
  }

  /** Of a scan in another coordinate system, the server says where its points are in WGS 84. */
  async #saveGeoJson() {
    const cloud = this.#cloud;
    const points = this.#points;
    try {
      const lonlat = isWgs84(cloud) ? undefined : await this.#viewer.server.lonlat(cloud.id, points.flatMap((one) => one.points));
      if (cloud === this.#cloud) this.#download('geojson', 'application/geo+json', () => geoJsonOf(points, lonlat));
    } catch (/** @type {any} */ error) {
      this.#page.overlays.toast(messages.noGeoJson, error.title ? error.message : strings.messages.noAnswer);
    }
  }

  #connectFiles() {
    const on = (id, act) => find(id).addEventListener('click', act);
    on('export-csv', () => this.#download('csv', 'text/csv', () => csvOf(this.#points, this.#cloud, words.kinds)));
    on('export-dxf', () => this.#download('dxf', 'image/vnd.dxf', () => dxfOf(this.#points, this.#cloud, words.kinds, unitOf(this.#cloud.crsUnit, this.#page.unit()))));
    on('export-geojson', () => this.#saveGeoJson());
    on('save-project', () => this.save());
    acceptFiles(find('open-project'), find('project-file'), (file) => this.open(file));
  }

  /** A project file, chosen or dropped. */
  async open(file) {
    const { overlays } = this.#page;
    let project;
    try {
      project = await readProject(file);
    } catch (/** @type {any} */ error) {
      overlays.toast(messages.notOpened, error.message);
      return;
    }
    const { id } = project.cloud;
    const isHere = id === this.#cloud?.id;
    if (!isHere && !this.#viewer.catalog.clouds.some((one) => one.id === id)) {
      overlays.toast(messages.notOpened, messages.noCloud(id));
      return;
    }
    const view = parseHash(`#${project.view}`);
    this.#soon(id, () => this.#use(project));
    if (view || !isHere) this.#viewer.restore({ ...view, cloud: id });
  }

  #use(project) {
    const { cloud, unit, measures, notes, views, tours, kept } = project;
    this.#kept = kept;
    if (unit) this.#page.setUnit(unit);
    this.#measures.replace(measures.map((one) => ({ ...one, name: one.name || words.kinds[one.kind] })));
    this.notes.replace(notes);
    this.views.replace(views);
    this.tours.replace(toursOf(tours, this.views.list));
    this.#page.opened(project);
    if (cloud.revision && cloud.revision !== this.#cloud.revision) this.#page.overlays.toast(messages.otherState, messages.otherStateDetail);
    else this.#page.overlays.toast(messages.opened, messages.openedDetail({ measures, notes, views }), 'done');
  }
}
