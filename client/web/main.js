// Puts the page together: the viewer, and around it panel, title, buttons and keys.

import { takeGuestToken } from './connection/guest.js';
import { Choices } from './page/choices.js';
import { ChosenMethod } from './page/chosen_method.js';
import { Controls } from './page/controls.js';
import { Cover } from './page/cover.js';
import { Galleries } from './page/galleries.js';
import { Address, Undo } from './page/history.js';
import { Hud } from './page/hud.js';
import { Layout } from './page/layout.js';
import { LoadingNote } from './page/loading_note.js';
import { ClassList } from './page/plan/class_list.js';
import { OnPicture } from './page/plan/on_picture.js';
import { Overlays } from './page/overlays.js';
import { PageTools } from './page/page_tools.js';
import { asksToPresent, Presentation } from './page/presentation.js';
import { showScan } from './page/scan_facts.js';
import { copyLink } from './page/share.js';
import { Stations } from './page/stations.js';
import { fillStrings, strings } from './page/strings.js';
import { chooseTheme, chosenTheme, themes } from './page/themes.js';
import { ToolRail } from './page/tools.js';
import { parseHash, printHash } from './view/view_hash.js';
import { isForView } from './view/keys.js';
import './scancast-view.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);

const { viewer } = find('view');
const { access } = viewer.server;
takeGuestToken(access); // before anything reads the address
fillStrings(document);

const canvas = find('picture');

/** The part of the canvas that a fitted cloud should fill: free of rail, title and buttons, but for little windows. */
function freeSize({ width, height }) {
  const { offsetWidth, offsetHeight } = find('rail'); // at the side, or along the lower edge; nothing in presentations
  const sides = offsetHeight > offsetWidth ? 2 * offsetWidth + 60 : 24;
  return { width: Math.max(width - sides, 0.8 * width), height: Math.max(height - (offsetWidth > 0 ? 170 : 80), 0.7 * height) };
}

const presentation = new Presentation((on) => {
  if (on) tools.close(); // what has been measured stays in the picture
  else tools.stopTour();
  address.changed();
});
const layout = new Layout();
const rail = new ToolRail(find('rail'));
viewer.freeSize = freeSize;
const hud = new Hud();
const overlays = new Overlays();
const cover = new Cover({
  retry: () => viewer.retryNow(),
  token: (token, remember) => viewer.unlock(token, remember),
  cloud: (id) => viewer.open(id),
});
const loading = new LoadingNote();
const chosen = new ChosenMethod();
const controls = new Controls({
  style: (changes) => viewer.changeStyle(changes),
  list: () => viewer.refreshClouds(),
  cloud: (id) => viewer.open(id),
  upAxis: (axis) => viewer.turnUp(axis),
  reset: () => viewer.resetStyle(),
  gallery: (open) => galleries.show('methods', open),
});
const tools = new PageTools(viewer, rail, {
  overlays, chosen, hash: () => viewHash() ?? '', changed: () => address.changed(), galleries: () => galleries, onPicture: () => onPicture,
});
const galleries = new Galleries(viewer, () => controls);
const onPicture = new OnPicture(viewer);
const classes = new ClassList((word) => viewer.changeStyle({ classes: word }));
const stations = new Stations(viewer.server, (station) => {
  viewer.goToPlace(station.view.camera);
  tools.atStation(station);
});

// ---- what the viewer tells

const on = (name, act) => viewer.addEventListener(name, (/** @type {any} */ { detail }) => act(detail));

on('connection', (now) => {
  if (now.kind === 'lost') hud.setState('lost');
  else if (now.kind !== 'open') hud.setState('connecting');
  else hud.begin();
  cover.show(now, viewer.isBlank ? undefined : viewer.cloud);
  if (now.kind === 'gone' || now.kind === 'failed') overlays.dismiss(); // the cover says it better
  if (now.kind !== 'open' && now.kind !== 'lost') loading.show(undefined);
  find('forget-token').hidden = !access.hasToken || access.isGuest;
  document.body.classList.toggle('ready', now.kind === 'open' || !viewer.isBlank);
});
on('catalog', (catalog) => {
  controls.setCatalog(catalog);
  chosen.setMethods(catalog.methods);
});
on('clouds', (catalog) => {
  controls.setClouds(catalog);
  showLoading();
});
on('jump', () => address.jump());
on('sought', ({ cloud }) => {
  sought = cloud;
  address.changed();
  address.flush();
});
on('cloud', (cloud) => {
  sought = undefined;
  showScan(cloud);
  tools.show(cloud);
  showCamera();
  controls.show(viewer.view, cloud);
  classes.show(viewer.view, cloud);
  showLoading();
  showMethod();
  stations.show(cloud);
});
on('view', ({ by }) => {
  if (by !== 'hand') {
    controls.show(viewer.view, viewer.cloud);
    classes.show(viewer.view, viewer.cloud);
    showMethod();
  }
  address.changed();
  undo.changed(by === 'server');
});
on('camera', ({ by }) => {
  if (by !== 'server') find('hint').classList.add('learned');
  showCamera();
});
on('begin', () => hud.setState('moving'));
on('asked', ({ seq }) => hud.asked(seq));
on('frame', (frame) => {
  document.body.classList.add('ready');
  // A still of a view that has been left again says nothing about the one that is wanted now.
  hud.frame(frame.current ? frame : { ...frame, final: false, still: false });
});
on('unreadable', () => overlays.toast(strings.messages.unreadable, strings.messages.unreadableDetail));
on('stats', (stats) => {
  chosen.told(stats, viewer.cloud);
  controls.told(stats);
  showMethod();
  hud.stats(stats);
});
on('problem', (problem) => overlays.toast(problem?.title || strings.messages.refused, problem?.detail ?? ''));

function showLoading() {
  loading.show(viewer.catalog.clouds.find((one) => one.id === viewer.cloud?.id));
}

function showMethod() {
  chosen.show(viewer.view, viewer.cloud);
  hud.setMethod(chosen.words(viewer.view, viewer.cloud));
}

// ---- the address, and undo

let sought; // the cloud that somebody asked for, until one is shown
let known = location.hash; // what the address is known to say

/** The view that is wanted, as the address says it; `present` is the page's own word. */
function hashNow() {
  const hash = viewHash();
  if (!hash) return hash;
  const whole = sought ? hash : `${hash}${tools.hashPart(hash.length)}`;
  return presentation.isOn ? `${whole}&present` : whole;
}

function viewHash() {
  const { place, cloud } = viewer;
  if (sought) return `#cloud=${sought}`;
  return place && printHash(place.cloud, { ...place.style, camera: place.camera }, place.upAxis, cloud.view);
}

const address = new Address(hashNow, (hash, pushes) => {
  const state = { untouched: viewer.isUntouched };
  try {
    if (pushes && hash !== known) history.pushState(state, '', hash);
    else history.replaceState(state, '', hash);
    known = location.hash;
  } catch {
    address.changed(); // too often, for this browser: in a moment, then
  }
});

const undo = new Undo(
  () => viewer.place && { ...viewer.place, key: viewHash() },
  (step) => viewer.restore(step),
  ({ canUndo, canRedo }) => {
    find('undo').disabled = !canUndo;
    find('redo').disabled = !canRedo;
  },
);

function addressChanged() {
  if (takeGuestToken(access)) {
    location.reload(); // another guest's link, put into the address of this page
    return;
  }
  if (location.hash === known) return;
  known = location.hash;
  address.arrived();
  const link = parseHash(known);
  if (!history.state) tools.arrived(known); // an address from elsewhere, not one that was left here
  if (link) viewer.restore(link);
}

for (const name of ['popstate', 'hashchange']) addEventListener(name, addressChanged);
addEventListener('pagehide', () => address.flush());
document.addEventListener('visibilitychange', () => document.hidden && address.flush());

find('forget-token').addEventListener('click', () => viewer.forgetToken());
find('undo').addEventListener('click', () => undo.undo());
find('redo').addEventListener('click', () => undo.redo());
addEventListener('keydown', (event) => {
  const typing = event.target instanceof Element && event.target.closest('input:not([type=checkbox], [type=radio], [type=range], [type=color]), textarea');
  if (!(event.ctrlKey || event.metaKey) || event.altKey || typing || document.querySelector('dialog[open]')) return;
  const key = event.key.toLowerCase();
  if (key !== 'z' && key !== 'y') return;
  event.preventDefault();
  if (key === 'y' || event.shiftKey) undo.redo();
  else undo.undo();
});

// ---- tools, buttons, keys

/** What of the camera buttons and menus tell. */
function showCamera() {
  find('orthographic').setAttribute('aria-pressed', String(viewer.camera?.projection === 'orthographic'));
  find('up-axis').value = viewer.camera?.upAxis ?? 'z';
}

function setLooking(looks) {
  viewer.looksAround = looks;
  rail.setMode(looks ? 'look' : 'orbit');
  showHint(looks);
}

/** What a newcomer is told: [what to do, what it does]. */
function showHint(looks) {
  for (const [kind, pairs] of Object.entries(strings.hint)) {
    const parts = pairs(looks).flatMap(([act, effect], i) => [i > 0 ? ' · ' : '', Object.assign(document.createElement('b'), { textContent: act }), ` ${effect}`]);
    document.querySelector(`#hint .for-${kind}`).replaceChildren(...parts);
  }
}

const { tools: words } = strings;
rail.register({ id: 'orbit', mode: 'navigate', label: words.orbit, tip: words.orbitTip, icon: 'orbit', activate: () => setLooking(false) });
rail.register({
  id: 'look', mode: 'navigate', label: words.look, tip: words.lookTip, icon: 'look', elementId: 'look-around', activate: () => setLooking(true),
});
rail.register({
  id: 'views', label: words.views, tip: words.viewsTip, icon: 'views', key: 'v', activate: () => find('views-gallery').togglePopover(),
});
rail.register({ id: 'picture', label: words.picture, tip: words.pictureTip, icon: 'picture', elementId: 'save-picture', activate: (button) => tools.savePicture(button) });
rail.register({ id: 'present', label: words.present, tip: words.presentTip, icon: 'present', key: 'h', activate: () => presentation.toggle() });

find('views-gallery').addEventListener('toggle', ({ newState }) => newState === 'open' && tools.showViews());
setLooking(false);

const theme = new Choices(find('theme'), chooseTheme);
theme.fill(themes.map((value) => ({ value, label: strings.theme[value] })));
theme.show(chosenTheme());

function setColliding(collides) {
  viewer.collides = collides;
  find('collides').checked = collides;
}
find('collides').addEventListener('change', (event) => setColliding(/** @type {any} */ (event.target).checked));

function toggleColliding() {
  setColliding(!viewer.collides);
  const [title, detail] = viewer.collides ? strings.messages.stops : strings.messages.passes;
  overlays.toast(title, detail, 'done');
}

const shortcuts = {
  f: () => viewer.showStandardView('fit'), Home: () => viewer.showStandardView('first'),
  1: () => viewer.showStandardView('top'), 2: () => viewer.showStandardView('front'), 3: () => viewer.showStandardView('side'),
  4: () => viewer.showStandardView('back'), 5: () => viewer.showStandardView('left'), 6: () => viewer.showStandardView('bottom'),
  7: () => onPicture.togglePlan(), g: () => onPicture.toggle('grid'), n: () => onPicture.toggle('minimap'),
  Enter: (event) => viewer.goToMiddle(event.shiftKey),
  c: toggleColliding, l: () => setLooking(!viewer.looksAround), o: () => viewer.toggleProjection(), p: () => layout.toggle(), j: () => tools.playTour(), '?': () => overlays.toggleHelp(),
};

addEventListener('keydown', (event) => {
  if (event.repeat) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const closesHelp = key === '?' && find('help').open;
  const tool = rail.withKey(key);
  if ((!Object.hasOwn(shortcuts, key) && !tool) || !(isForView(event) || closesHelp)) return;
  event.preventDefault(); // a menu that has the focus would go to its next entry of that letter
  if (presentation.isOn && (['p', 'v', 'n'].includes(key) || tools.hasKey(key))) return; // what they open is not there
  if (tool) rail.activate(tool);
  else shortcuts[key](event);
});

for (const button of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll('[data-view]'))) {
  button.addEventListener('click', () => viewer.showStandardView(button.dataset.view));
}
find('orthographic').addEventListener('click', () => viewer.toggleProjection());
find('copy-link').addEventListener('click', () => {
  if (!viewer.cloud) return;
  address.changed();
  address.flush();
  copyLink(overlays);
});
const link = parseHash(location.hash);
tools.arrived(location.hash);
if (asksToPresent(location.hash)) presentation.enter({ fullScreen: false });
// Who has touched nothing before he reloads sees the cloud as the server would show it now, in a window of another size, too.
viewer.start(history.state?.untouched ? { cloud: link?.cloud } : link);
