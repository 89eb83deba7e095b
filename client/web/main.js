// Puts the page together: what the user wants (camera and style) goes out as `view` messages, at most one for each
// frame of the display; the pictures that come back go onto the canvas.

import { between, fit, fittedInto, fromProtocol, radiusOf, standardView, toProtocol } from './camera.js';
import { CameraInput } from './camera_input.js';
import { Controls } from './controls.js';
import { takeGuestToken } from './guest.js';
import { amount, Hud } from './hud.js';
import { Overlays } from './overlays.js';
import { Photos } from './photos.js';
import { Picture } from './picture.js';
import { Session } from './session.js';
import { copyLink, savePicture } from './share.js';
import { Stations } from './stations.js';
import { parseHash } from './view_hash.js';
import { ViewState } from './view_state.js';

const find = (id) => document.getElementById(id);
const styleKeys = ['method', 'param', 'color', 'colormap', 'range', 'shading', 'mirrors', 'behindMirrors', 'background', 'detail'];
const flightMs = 260;
const calm = matchMedia('(prefers-reduced-motion: reduce)');
const narrow = matchMedia('(max-width: 700px)');

takeGuestToken(); // before anything reads the address

const canvas = find('picture');
const state = new ViewState();
const hud = new Hud();

let catalog = { clouds: [], pending: [] };
let cloud; // what the server says of the cloud on screen
let camera; // undefined until there is something to look at
let flight; // { from, to, start } while the camera flies by itself
let link = parseHash(location.hash); // a view to restore, once connected
let moved = false, styled = false; // by somebody; else camera and style are those that the server chose
let firstWanted = 0; // frames of earlier views are not what the user asked for
let scheduled = false;
let lastTick = 0;

const session = new Session({
  state: (now) => {
    if (now.kind === 'lost') hud.setState('lost');
    else if (now.kind !== 'open') hud.setState('connecting');
    overlays.connection(now, !picture.isBlank);
    document.body.classList.toggle('ready', now.kind === 'open' || !picture.isBlank);
  },
  catalog: (fresh) => {
    catalog = fresh;
    controls.setCatalog(fresh);
    if ([...fresh.clouds, ...fresh.pending].some((entry) => entry.state === 'loading')) setTimeout(() => session.refreshCatalog(), 2000);
  },
  clouds: (fresh) => {
    catalog = { ...catalog, ...fresh };
    controls.setClouds(catalog);
    renew();
    if ([...fresh.clouds, ...fresh.pending].some((entry) => entry.state === 'loading')) setTimeout(() => session.refreshCatalog(), 2000);
  },
  hello: () => {
    const { width, height, ratio } = picture.size;
    return { width, height, pixelRatio: Math.min(8, Math.max(0.25, ratio)) };
  },
  welcome,
  frame: showFrame,
  problem: showProblem,
  stats: (stats) => hud.stats(stats),
});

const overlays = new Overlays(() => session.retryNow(), (token) => session.unlock(token));
const picture = new Picture(canvas, (size) => {
  state.change({ width: size.width, height: size.height });
  wake();
});
const controls = new Controls({
  style: changeStyle,
  cloud: (id) => openCloud(id),
  upAxis: (axis) => {
    if (!cloud) return;
    changeCamera(usualCamera(cloud, axis));
    showCameraButtons();
  },
  reset: () => changeStyle(usualStyle(cloud)),
});
const photos = new Photos(goToPlace, () => picture.size);
const stations = new Stations((station) => {
  goToPlace(station.view.camera);
  photos.at(station);
}, amount);
const input = new CameraInput(canvas, {
  get camera() { return session.connection ? camera : undefined; },
  get size() { return picture.cssSize; },
  get closest() { return Math.max((cloud?.spacing ?? 0) * 20, radiusOf(boundsOf()) * 1e-4); },
  get looksAround() { return find('look-around').getAttribute('aria-pressed') === 'true'; },
  changeCamera,
  goTo,
  wake,
});

// ---- the view that is wanted

const unitBox = { min: [-1, -1, -1], max: [1, 1, 1] };
const boundsOf = () => cloud?.bounds ?? unitBox;

/** The style in which the server would show the cloud by itself. */
const usualStyle = (of) => Object.fromEntries(styleKeys.map((key) => [key, of?.view?.[key] ?? null]));

/** The part of the window that a fitted cloud should fill: free of panel and buttons, but for little windows. */
function freeSize() {
  const { width, height } = picture.cssSize;
  const panel = narrow.matches ? 0 : find('panel').offsetWidth + 20;
  return { width: Math.max(width - 2 * panel, 0.7 * width), height: Math.max(height - 160, 0.7 * height) };
}

/** The axis that the server takes for up, which it tells by its default view. */
function usualUpAxis(of) {
  const y = of.look?.up?.[1] ?? of.view?.camera?.up?.[1] ?? 0;
  return y > 0.5 ? 'y' : y < -0.5 ? '-y' : 'z';
}

/** From where the server would look at the cloud; unless that is inside, fitted to this window. */
function usualCamera(of, upAxis = usualUpAxis(of)) {
  const theirs = fromProtocol(of.view?.camera, usualUpAxis(of)) ?? fromProtocol({ eye: [1, -2, 1], target: [0, 0, 0] });
  const first = of.look?.views?.[0];
  if (!first || upAxis !== usualUpAxis(of)) return fit({ ...theirs, upAxis }, of.bounds, picture.cssSize, freeSize());
  return first.inside ? theirs : fittedInto(theirs, picture.cssSize, freeSize());
}

function welcome(message) {
  const known = cloud?.id === message.cloud;
  cloud = catalog.clouds.find((one) => one.id === message.cloud) ?? { id: message.cloud, bounds: unitBox, view: message.view };
  picture.newStream();
  picture.setLimit(message.limits?.maxPixels ?? 0);
  hud.clock.reset();
  hud.setDamaged(false);
  const restored = link && (!link.cloud || link.cloud === cloud.id) ? link : undefined;
  if (link?.cloud && !restored) overlays.toast('Another cloud', `This server has no cloud named ${link.cloud}.`);
  link = undefined;
  if (restored || !known || !camera) {
    moved = styled = Boolean(restored);
    camera = restored?.camera ?? usualCamera(cloud);
  }
  const style = known && !restored ? Object.fromEntries(styleKeys.map((key) => [key, state.wanted[key]])) : usualStyle(cloud);
  begin({ ...style, ...restored?.style });
}

/** The cloud as it is now, of which a first part was shown; who has not moved yet sees it as the server would show it. */
function renew() {
  const fresh = catalog.clouds.find((one) => one.id === cloud?.id);
  if (!fresh || fresh.revision === cloud.revision) return;
  cloud = fresh;
  if (!moved && !styled) {
    camera = usualCamera(cloud);
    begin(usualStyle(cloud));
  } else {
    controls.show(state.wanted, cloud);
    stations.show(cloud);
    photos.show(cloud);
  }
}

/** From here on the server shows this cloud, with that style, from where the camera is. */
function begin(style) {
  const { width, height } = picture.size;
  state.begin({ cloud: cloud.id, camera: toProtocol(camera, boundsOf()), width, height, ...style });
  firstWanted = session.connection?.nextSeq ?? 0;
  showTitle();
  showCameraButtons();
  controls.show(state.wanted, cloud);
  stations.show(cloud);
  photos.show(cloud);
  wake();
}

function openCloud(id) {
  const next = catalog.clouds.find((one) => one.id === id);
  if (!next || next === cloud) return;
  flight = undefined;
  moved = false;
  cloud = next;
  session.remember(id);
  camera = usualCamera(cloud);
  const own = usualStyle(cloud);
  // A way of drawing that somebody chose stays; what only the other cloud may have had does not.
  const keep = !styled ? [] : ['method', 'param', 'shading', 'mirrors', 'behindMirrors', 'background', 'detail', 'colormap'];
  begin({ ...own, ...Object.fromEntries(keep.map((key) => [key, state.wanted[key]])) });
}

function changeStyle(changes) {
  if (!cloud) return;
  styled = true;
  state.change(changes);
  controls.show(state.wanted, cloud);
  wake();
}

function changeCamera(next) {
  if (!camera || next === camera) return;
  moved = true;
  flight = undefined;
  camera = next;
  find('hint').classList.add('learned');
  state.change({ camera: toProtocol(camera, boundsOf()) });
  wake();
}

/** A jump, shown as a short flight so that one sees where it leads. */
function goTo(next) {
  if (calm.matches) {
    changeCamera(next);
    return;
  }
  flight = { from: camera, to: next, start: performance.now() };
  wake();
}

/** As the protocol has it: where a scanner stood, where a photo was taken. */
function goToPlace(place) {
  const next = fromProtocol(place, camera?.upAxis ?? 'z');
  if (next && camera) goTo(next);
}

// ---- one tick for each frame of the display

function wake() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(tick);
}

function tick(now) {
  scheduled = false;
  const seconds = Math.min(0.1, Math.max(0, (now - lastTick) / 1000));
  lastTick = now;
  if (flight) fly();
  else if (input.keysAreHeld && camera) changeCamera(input.advance(camera, seconds));
  send();
  if (flight || input.keysAreHeld || (session.connection && state.hasNews())) wake();
}

function fly() {
  const { from, to, start } = flight;
  const t = Math.min(1, (performance.now() - start) / flightMs);
  const smooth = t * t * (3 - 2 * t);
  const next = t < 1 ? between(from, to, smooth) : to;
  const going = t < 1 ? flight : undefined;
  changeCamera(next);
  flight = going;
}

function send() {
  const { connection } = session;
  // While the line is full, requests overwrite each other here: the next tick sends the newest.
  if (!connection || !camera || connection.congested) return;
  const changes = state.take(connection.nextSeq);
  if (!changes) return;
  const seq = connection.sendView(changes);
  canvas.dataset.asked = String(seq);
  hud.clock.asked(seq, performance.now());
  hud.setState('moving');
}

// ---- what comes back

async function showFrame(frame) {
  const { connection } = session;
  try {
    if (frame.seq >= firstWanted && (await picture.show(frame))) {
      state.shown(frame.seq);
      canvas.dataset.shown = String(frame.seq);
      canvas.dataset.frame = String(frame.frameId);
      document.body.classList.add('ready');
      // A still of a view that has been left again says nothing about the one that is wanted now.
      hud.frame(frame.seq === connection?.nextSeq - 1 ? frame : { ...frame, final: false, still: false });
    }
  } catch {
    overlays.toast('A picture was unreadable', 'The next one will replace it.');
  }
  // Only now, so that a slow machine is not sent more than it can decode.
  connection?.acknowledge(frame.frameId);
}

function showProblem({ seq, problem }) {
  overlays.toast(problem?.title || 'The server refused', problem?.detail ?? '');
  if (seq === undefined || !cloud) return;
  const sound = { ...state.wanted, ...usualStyle(cloud), camera: toProtocol(usualCamera(cloud), boundsOf()) };
  if (!state.refused(seq, sound)) return;
  const was = catalog.clouds.find((one) => one.id === state.wanted.cloud);
  if (was) cloud = was;
  camera = fromProtocol(state.wanted.camera, camera.upAxis) ?? camera;
  controls.show(state.wanted, cloud);
  showTitle();
  wake();
}

// ---- title, buttons, keys

function showTitle() {
  const title = cloud.title || cloud.id;
  document.title = `${title} · Scancast`;
  find('cloud-title').textContent = title;
  canvas.setAttribute('aria-label', `The point cloud ${title}`);
  const { min, max } = boundsOf();
  const extent = [0, 1, 2].map((i) => Number((max[i] - min[i]).toPrecision(3)).toLocaleString('en')).join(' × ');
  const facts = [`${amount(cloud.points)} points`, extent, cloud.format?.split(',')[0]].filter(Boolean);
  find('cloud-facts').textContent = facts.join(' · ');
}

function showCameraButtons() {
  find('orthographic').setAttribute('aria-pressed', String(camera?.projection === 'orthographic'));
  find('up-axis').value = camera?.upAxis ?? 'z';
}

function toggleProjection() {
  if (!camera) return;
  const projection = camera.projection === 'orthographic' ? 'perspective' : 'orthographic';
  changeCamera({ ...camera, projection });
  showCameraButtons();
}

function toggleLooking() {
  const button = find('look-around');
  const looks = button.getAttribute('aria-pressed') !== 'true';
  button.setAttribute('aria-pressed', String(looks));
  for (const verb of document.querySelectorAll('.drag-verb')) verb.textContent = looks ? 'look around' : 'orbit';
}

/** All of the cloud from the direction that the camera has: as at first, where that is the first one. */
function everything(room) {
  const first = usualCamera(cloud, camera.upAxis);
  const isFirst = ['azimuth', 'elevation', 'fov', 'projection'].every((key) => first[key] === camera[key]);
  return isFirst ? first : fit(camera, ...room);
}

function showStandardView(name) {
  if (!camera || !cloud) return;
  const room = [boundsOf(), picture.cssSize, freeSize()];
  goTo(name === 'fit' ? everything(room) : standardView(camera, name, ...room));
}

function showPanel(open) {
  document.body.classList.toggle('panel-closed', !open);
  find('toggle-panel').setAttribute('aria-expanded', String(open));
}
const togglePanel = () => showPanel(document.body.classList.contains('panel-closed'));

const shortcuts = {
  f: () => showStandardView('fit'), Home: () => showStandardView('fit'),
  1: () => showStandardView('top'), 2: () => showStandardView('front'), 3: () => showStandardView('side'),
  l: toggleLooking, o: toggleProjection, p: togglePanel, '?': () => overlays.toggleHelp(),
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
  button.addEventListener('click', () => showStandardView(button.dataset.view));
}
find('look-around').addEventListener('click', toggleLooking);
find('orthographic').addEventListener('click', toggleProjection);
find('toggle-panel').addEventListener('click', togglePanel);
find('copy-link').addEventListener('click', () => {
  if (cloud) copyLink(cloud.id, state.wanted, camera.upAxis, overlays);
});
find('save-picture').addEventListener('click', async ({ currentTarget: button }) => {
  if (!cloud) return;
  button.disabled = true;
  await savePicture(cloud.id, state.wanted, picture.size, overlays);
  button.disabled = false;
});
addEventListener('hashchange', () => {
  if (takeGuestToken()) {
    location.reload(); // another guest's link, put into the address of this page
    return;
  }
  const next = parseHash(location.hash);
  if (!next || !cloud) return;
  if (next.cloud && next.cloud !== cloud.id) openCloud(next.cloud);
  if (next.camera) {
    goTo(next.camera);
    find('up-axis').value = next.camera.upAxis;
  }
  changeStyle(next.style);
});

showPanel(!narrow.matches);
session.start(link?.cloud);
