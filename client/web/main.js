// Puts the page together: the viewer, and around it panel, title, buttons and keys.

import { takeGuestToken } from './connection/guest.js';
import { Choices } from './page/choices.js';
import { Controls } from './page/controls.js';
import { Galleries } from './page/galleries.js';
import { Hud } from './page/hud.js';
import { Layout } from './page/layout.js';
import { Overlays } from './page/overlays.js';
import { Photos } from './page/photos.js';
import { asksToPresent, Presentation } from './page/presentation.js';
import { showScan } from './page/scan_facts.js';
import { copyLink, savePicture } from './page/share.js';
import { Stations } from './page/stations.js';
import { amount, fillStrings, strings } from './page/strings.js';
import { chooseTheme, chosenTheme, themes } from './page/themes.js';
import { ToolRail } from './page/tools.js';
import { parseHash } from './page/view_hash.js';
import { Viewer } from './view/viewer.js';

const find = (id) => document.getElementById(id);

takeGuestToken(); // before anything reads the address
fillStrings(document);

const canvas = find('picture');

/** The part of the canvas that a fitted cloud should fill: free of rail, title and buttons, but for little windows. */
function freeSize({ width, height }) {
  const { offsetWidth, offsetHeight } = find('rail'); // at the side, or along the lower edge; nothing in presentations
  const sides = offsetHeight > offsetWidth ? 2 * offsetWidth + 60 : 24;
  return { width: Math.max(width - sides, 0.8 * width), height: Math.max(height - (offsetWidth > 0 ? 170 : 80), 0.7 * height) };
}

const presentation = new Presentation();
const layout = new Layout();
const rail = new ToolRail(find('rail'));
const viewer = new Viewer(canvas, { freeSize });
const hud = new Hud();
const overlays = new Overlays(() => viewer.retryNow(), (token) => viewer.unlock(token));
const controls = new Controls({
  style: (changes) => viewer.changeStyle(changes),
  cloud: (id) => viewer.open(id),
  upAxis: (axis) => viewer.turnUp(axis),
  reset: () => viewer.resetStyle(),
  gallery: (open) => galleries.show('methods', open),
});
const galleries = new Galleries(viewer, () => controls);
const photos = new Photos((place) => viewer.goToPlace(place), () => viewer.pictureSize);
const stations = new Stations((station) => {
  viewer.goToPlace(station.view.camera);
  photos.at(station);
}, amount);

// ---- what the viewer tells

const on = (name, act) => viewer.addEventListener(name, ({ detail }) => act(detail));

on('connection', (now) => {
  if (now.kind === 'lost') hud.setState('lost');
  else if (now.kind !== 'open') hud.setState('connecting');
  else hud.begin();
  overlays.connection(now, !viewer.isBlank);
  document.body.classList.toggle('ready', now.kind === 'open' || !viewer.isBlank);
});
on('catalog', (catalog) => controls.setCatalog(catalog));
on('clouds', (catalog) => controls.setClouds(catalog));
on('missing', ({ cloud }) => overlays.toast(strings.messages.unknownCloud, strings.messages.unknownCloudDetail(cloud)));
on('cloud', (cloud) => {
  showScan(cloud);
  showCamera();
  controls.show(viewer.view, cloud);
  stations.show(cloud);
  photos.show(cloud);
});
on('view', ({ by }) => {
  if (by === 'style' || by === 'program') controls.show(viewer.view, viewer.cloud);
});
on('camera', () => {
  find('hint').classList.add('learned');
  showCamera();
});
on('asked', ({ seq }) => hud.asked(seq));
on('frame', (frame) => {
  document.body.classList.add('ready');
  // A still of a view that has been left again says nothing about the one that is wanted now.
  hud.frame(frame.current ? frame : { ...frame, final: false, still: false });
});
on('unreadable', () => overlays.toast(strings.messages.unreadable, strings.messages.unreadableDetail));
on('stats', (stats) => hud.stats(stats));
on('problem', (problem) => overlays.toast(problem?.title || strings.messages.refused, problem?.detail ?? ''));

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

async function saveThisPicture(button) {
  if (!viewer.cloud) return;
  button.disabled = true;
  await savePicture(viewer.cloud.id, viewer.view, viewer.pictureSize, overlays);
  button.disabled = false;
}

const { tools } = strings;
rail.register({ id: 'orbit', mode: 'navigate', label: tools.orbit, tip: tools.orbitTip, icon: 'orbit', activate: () => setLooking(false) });
rail.register({
  id: 'look', mode: 'navigate', label: tools.look, tip: tools.lookTip, icon: 'look', elementId: 'look-around', activate: () => setLooking(true),
});
rail.register({
  id: 'views', label: tools.views, tip: tools.viewsTip, icon: 'views', key: 'v', activate: () => find('views-gallery').togglePopover(),
});
rail.register({ id: 'picture', label: tools.picture, tip: tools.pictureTip, icon: 'picture', elementId: 'save-picture', activate: saveThisPicture });
rail.register({ id: 'present', label: tools.present, tip: tools.presentTip, icon: 'present', key: 'h', activate: () => presentation.toggle() });
setLooking(false);

const theme = new Choices(find('theme'), chooseTheme);
theme.fill(themes.map((value) => ({ value, label: strings.theme[value] })));
theme.show(chosenTheme());

const shortcuts = {
  f: () => viewer.showStandardView('fit'), Home: () => viewer.showStandardView('fit'),
  1: () => viewer.showStandardView('top'), 2: () => viewer.showStandardView('front'), 3: () => viewer.showStandardView('side'),
  l: () => setLooking(!viewer.looksAround), o: () => viewer.toggleProjection(), p: () => layout.toggle(), '?': () => overlays.toggleHelp(),
};

addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
  const inDialog = find('help').open;
  if (event.target instanceof Element && event.target.closest('input, select, textarea')) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const tool = rail.withKey(key);
  if ((!Object.hasOwn(shortcuts, key) && !tool) || (inDialog && key !== '?')) return;
  event.preventDefault();
  if (tool) rail.activate(tool);
  else shortcuts[key]();
});

for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => viewer.showStandardView(button.dataset.view));
}
find('orthographic').addEventListener('click', () => viewer.toggleProjection());
find('copy-link').addEventListener('click', () => {
  if (viewer.cloud) copyLink(viewer.cloud.id, viewer.view, viewer.camera.upAxis, overlays);
});
addEventListener('hashchange', () => {
  if (takeGuestToken()) {
    location.reload(); // another guest's link, put into the address of this page
    return;
  }
  const next = parseHash(location.hash);
  if (next) viewer.restore(next);
});

if (asksToPresent(location.hash)) presentation.enter({ fullScreen: false });
viewer.start(parseHash(location.hash));
