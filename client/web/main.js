// Puts the page together: the viewer, and around it panel, title, buttons and keys.

import { hasToken } from './connection/access.js';
import { isGuest, takeGuestToken } from './connection/guest.js';
import { Controls } from './page/controls.js';
import { ChosenMethod } from './page/chosen_method.js';
import { Cover } from './page/cover.js';
import { Address, Undo } from './page/history.js';
import { amount, Hud } from './page/hud.js';
import { LoadingNote } from './page/loading_note.js';
import { Overlays } from './page/overlays.js';
import { Photos } from './page/photos.js';
import { copyLink, savePicture } from './page/share.js';
import { Stations } from './page/stations.js';
import { parseHash, printHash } from './page/view_hash.js';
import { Viewer } from './view/viewer.js';

const find = (id) => document.getElementById(id);
const narrow = matchMedia('(max-width: 700px)');

takeGuestToken(); // before anything reads the address

const canvas = find('picture');

/** The part of the window that a fitted cloud should fill: free of panel and buttons, but for little windows. */
function freeSize({ width, height }) {
  const panel = narrow.matches ? 0 : find('panel').offsetWidth + 20;
  return { width: Math.max(width - 2 * panel, 0.7 * width), height: Math.max(height - 160, 0.7 * height) };
}

const viewer = new Viewer(canvas, { freeSize });
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
});
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
  cover.show(now, viewer.isBlank ? undefined : viewer.cloud);
  if (now.kind === 'gone' || now.kind === 'failed') overlays.dismiss(); // the cover says it better
  if (now.kind !== 'open' && now.kind !== 'lost') loading.show(undefined);
  find('forget-token').hidden = !hasToken() || isGuest();
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
  showTitle(cloud);
  showCamera();
  controls.show(viewer.view, cloud);
  showLoading();
  showMethod();
  stations.show(cloud);
  photos.show(cloud);
});
on('view', ({ by }) => {
  if (by !== 'hand') {
    controls.show(viewer.view, viewer.cloud);
    showMethod();
  }
  address.changed();
  undo.changed(by === 'server');
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
on('unreadable', () => overlays.toast('A picture was unreadable', 'The next one will replace it.'));
on('stats', (stats) => {
  chosen.told(stats, viewer.cloud);
  showMethod();
  hud.stats(stats);
});
on('problem', (problem) => overlays.toast(problem?.title || 'The server refused', problem?.detail ?? ''));

// ---- the address, and undo

let sought; // the cloud that somebody asked for, until one is shown
let known = location.hash; // what the address is known to say

/** The view that is wanted, as the address says it. */
function hashNow() {
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
  () => viewer.place && { ...viewer.place, key: hashNow() },
  (step) => viewer.restore(step),
  ({ canUndo, canRedo }) => {
    find('undo').disabled = !canUndo;
    find('redo').disabled = !canRedo;
  },
);

function addressChanged() {
  if (takeGuestToken()) {
    location.reload(); // another guest's link, put into the address of this page
    return;
  }
  if (location.hash === known) return;
  known = location.hash;
  address.arrived();
  const link = parseHash(known);
  if (link) viewer.restore(link);
}

for (const name of ['popstate', 'hashchange']) addEventListener(name, addressChanged);
addEventListener('pagehide', () => address.flush());
document.addEventListener('visibilitychange', () => document.hidden && address.flush());

find('forget-token').addEventListener('click', () => viewer.forgetToken());
find('undo').addEventListener('click', () => undo.undo());
find('redo').addEventListener('click', () => undo.redo());
addEventListener('keydown', (event) => {
  const typing = event.target instanceof Element && event.target.closest('input:not([type=checkbox], [type=range], [type=color]), textarea');
  if (!(event.ctrlKey || event.metaKey) || event.altKey || typing || document.querySelector('dialog[open]')) return;
  const key = event.key.toLowerCase();
  if (key !== 'z' && key !== 'y') return;
  event.preventDefault();
  if (key === 'y' || event.shiftKey) undo.redo();
  else undo.undo();
});

// ---- title, buttons, keys

function showLoading() {
  loading.show(viewer.catalog.clouds.find((one) => one.id === viewer.cloud?.id));
}

function showMethod() {
  chosen.show(viewer.view, viewer.cloud);
  hud.setMethod(chosen.words(viewer.view, viewer.cloud));
}

function showTitle(cloud) {
  const title = cloud.title || cloud.id;
  document.title = `${title} · Scancast`;
  find('cloud-title').textContent = title;
  canvas.setAttribute('aria-label', `The point cloud ${title}`);
  const { min, max } = viewer.bounds;
  const extent = [0, 1, 2].map((i) => Number((max[i] - min[i]).toPrecision(3)).toLocaleString('en')).join(' × ');
  const facts = [`${amount(cloud.points)} points${cloud.state === 'loading' ? ' so far' : ''}`, extent, cloud.format?.split(',')[0]].filter(Boolean);
  find('cloud-facts').textContent = facts.join(' · ');
}

/** What of the camera buttons and menus tell. */
function showCamera() {
  find('orthographic').setAttribute('aria-pressed', String(viewer.camera?.projection === 'orthographic'));
  find('up-axis').value = viewer.camera?.upAxis ?? 'z';
}

function toggleLooking() {
  viewer.looksAround = !viewer.looksAround;
  find('look-around').setAttribute('aria-pressed', String(viewer.looksAround));
  for (const verb of document.querySelectorAll('.drag-verb')) verb.textContent = viewer.looksAround ? 'look around' : 'orbit';
}

function showPanel(open) {
  document.body.classList.toggle('panel-closed', !open);
  find('toggle-panel').setAttribute('aria-expanded', String(open));
}
const togglePanel = () => showPanel(document.body.classList.contains('panel-closed'));

const shortcuts = {
  f: () => viewer.showStandardView('fit'), Home: () => viewer.showStandardView('fit'),
  1: () => viewer.showStandardView('top'), 2: () => viewer.showStandardView('front'), 3: () => viewer.showStandardView('side'),
  l: toggleLooking, o: () => viewer.toggleProjection(), p: togglePanel, '?': () => overlays.toggleHelp(),
};

addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
  const inDialog = find('help').open;
  if (event.target instanceof Element && event.target.closest('input, select, textarea')) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (!Object.hasOwn(shortcuts, key) || (inDialog && key !== '?')) return;
  event.preventDefault();
  shortcuts[key]();
});

for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => viewer.showStandardView(button.dataset.view));
}
find('look-around').addEventListener('click', toggleLooking);
find('orthographic').addEventListener('click', () => viewer.toggleProjection());
find('toggle-panel').addEventListener('click', togglePanel);
find('copy-link').addEventListener('click', () => {
  if (!viewer.cloud) return;
  address.changed();
  address.flush();
  copyLink(overlays);
});
find('save-picture').addEventListener('click', async ({ currentTarget: button }) => {
  if (!viewer.cloud) return;
  button.disabled = true;
  await savePicture(viewer.cloud.id, viewer.view, viewer.pictureSize, overlays);
  button.disabled = false;
});
showPanel(!narrow.matches);
narrow.addEventListener('change', () => showPanel(!narrow.matches));

const link = parseHash(location.hash);
// Who has touched nothing before he reloads sees the cloud as the server would show it now, in a window of another size, too.
viewer.start(history.state?.untouched ? { cloud: link?.cloud } : link);
