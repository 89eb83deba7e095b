// A cloud on a canvas: what is wanted of it (camera and style) goes out as `view` messages, at most one for each frame
// of the display; the pictures that come back go onto the canvas. It knows no other element of the page: what happens is
// told by events, and what others may do with it are its methods.
//
// Events, each a CustomEvent whose `detail` is:
//
//   connection  { kind, … } as session.js reports it
//   catalog     what the server offers: { clouds, pending, methods, colors, colormaps, shadings, ramps }
//   clouds      the same, when only the list of clouds is another one
//   cloud       what the server says of the cloud that is shown from now on, or of the same one as it is now
//   jump        another place is about to be shown, at once or by a short flight
//   sought      { cloud }: one is asked for that cannot be shown yet, or not at all; `connection` tells more
//   begin       nothing: another cloud, or another connection; the picture on the canvas is not of it
//   view        { by }: another view is wanted; by 'hand', 'style', 'program' (a flight, a restored view) or 'server'
//   camera      the same, of the camera alone, with every step of it: { by }
//   asked       { seq }: the server has been told
//   frame       the frame that has just been drawn, `current`: whether it shows what was asked for last; `movingFrames`: how those come
//   shown       nothing: what is on the canvas may look from elsewhere than before (`shownPose`)
//   unreadable  nothing: a picture could not be decoded
//   stats, problem  as the protocol has them

import { Session } from '../connection/session.js';
import { styleKeys } from '../protocol/view_words.js';
import { leastDistanceTo, mostDistanceTo, surfaceUnder } from './anchor.js';
import { Exchange } from './exchange.js';
import { FirstViews } from './first_views.js';
import { between, fit, fittedInto, fromProtocol, radiusOf, standardView } from './camera.js';
import { CameraInput } from './camera_input.js';
import { cameraOf, wireOf } from './camera_words.js';
import { MovingFrames } from './moving_frames.js';
import { Picture } from './picture.js';
import { askable, boundsOf, pick, restyled, usualStyle, usualUpAxis } from './usual.js';

/** What stays when somebody goes to another cloud, if he chose it: a way of drawing; nothing that only one of them may have. */
const lastingKeys = ['method', 'param', 'shading', 'mirrors', 'behindMirrors', 'background', 'detail', 'colormap', 'budget', 'samples',
  'quality', 'subsampling'];
/** Kinds of scenes below which there is nothing to be seen; one may walk around a thing below, too. */
const groundKinds = ['airborne', 'street'];
const flightMs = 260;
const restMs = { free: 80, held: 300 }; // after its last step the camera is at rest; the hand may still be on it
const firstViewPatienceMs = 700;
const loadingPollMs = 2000;
const unitBox = { min: [-1, -1, -1], max: [1, 1, 1] };

export class Viewer extends EventTarget {
  #exchange;
  #picture;
  #session;
  #movingFrames = new MovingFrames(() => this.#session.renew());
  #input;
  #calm = matchMedia('(prefers-reduced-motion: reduce)');

  #catalog = { clouds: [], pending: [] };
  #cloud; // what the server says of the cloud on screen
  #camera; // undefined until there is something to look at
  #flight; // { from, to, start } while the camera flies by itself
  #isStopped = false;
  #nextList; // timer of the next question for the list, while one is loading
  #firstViews;
  #next; // of the calls of #showSoon(), the last one's
  #restore; // { cloud, camera, upAxis, style }: a view to begin with, once connected
  #moved = false; // by somebody; else the camera is the one that the server chose
  #styled = false; // the same of the style
  #scheduled = false;
  #lastTick = 0;
  #steered = -Infinity; // when the camera made its last step

  /** Whether dragging turns the head instead of the cloud. */
  looksAround = false;

  /** Whether surfaces stop who moves; else he passes through them. */
  collides = true;

  /** freeSize(cssSize): the part of the canvas, in its middle, that nothing lies over; a fitted cloud fills that. */
  freeSize = (cssSize) => cssSize;

  /** pickable(cursor): whether what is seen there is this viewer's: else nothing is picked there. */
  pickable = (_cursor) => true;

  /** What may be moved by hand: nothing where this is false. */
  steerable = true;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('../connection/server.js').Server} server whose clouds are shown
   * @param {EventTarget} keys whose key events steer the view: the window's, or one element's
   */
  constructor(canvas, server, keys = globalThis) {
    super();
    this.server = server;
    this.#picture = new Picture(canvas, ({ width, height }) => {
      this.#exchange.change({ width, height });
      if (!this.#moved) this.#refit();
      this.#wake();
    }, () => this.#tell('shown'));
    this.#exchange = new Exchange(canvas, this.#picture);
    this.#exchange.askable = (view) => askable(view, this.#cloud);
    this.#firstViews = new FirstViews(server);
    this.#session = new Session(server, {
      state: (now) => {
        this.#reproject(); // nothing newer is on its way where there is no connection
        this.#tell('connection', now);
      },
      expect: (cloud) => Promise.all([this.#movingFrames.ready, this.#moved || this.#restore?.camera ? undefined : this.#expected(cloud)]),
      catalog: (fresh) => this.#catalogCame(fresh),
      clouds: (fresh) => this.#cloudsCame(fresh),
      hello: () => {
        const { width, height, ratio } = this.#picture.size;
        return { width, height, pixelRatio: Math.min(8, Math.max(0.25, ratio)), depth: true, ...this.#movingFrames.words };
      },
      seen: (cloud, seq) => (this.#camera && this.view.cloud === cloud ? this.#exchange.say(seq, this.#camera) : undefined),
      welcome: (message) => this.#welcome(message),
      moved: (message, hello) => {
        this.#movingFrames.begin(message);
        this.#picture.newStream();
        this.#picture.setLimit(message.limits?.maxPixels ?? 0);
        // The same server remembers what it was asked for last, and does not look at what the hello said.
        const isRemembered = message.seq !== undefined && message.seq !== hello.seq;
        this.#exchange.moved(isRemembered ? { ...hello, view: undefined } : hello, this.#session.connection.nextSeq);
        this.#wake();
      },
      frame: (frame) => this.#showFrame(frame),
      problem: (message) => this.#refused(message),
      // Those of a picture of another cloud say nothing about this one.
      stats: (stats) => this.#exchange.isOfThis(stats.seq) && this.#tell('stats', stats),
    });
    const viewer = this;
    this.#input = new CameraInput(canvas, {
      get camera() { return viewer.steerable && viewer.#session.connection ? viewer.#camera : undefined; },
      get size() { return viewer.#picture.cssSize; },
      get pictures() { return viewer.#exchange.seen; },
      get limits() {
        const { bounds } = viewer;
        const size = { bounds, spacing: viewer.#cloud?.spacing };
        const hasGround = groundKinds.includes(viewer.#cloud?.look?.kind);
        return { bounds, hasGround, least: leastDistanceTo(size), most: mostDistanceTo(size) };
      },
      get collides() { return viewer.collides; },
      get calm() { return viewer.#calm.matches; },
      get looksAround() { return viewer.looksAround; },
      changeCamera: (next) => this.changeCamera(next),
      goTo: (next) => this.goTo(next, 'hand'),
      wake: () => this.#wake(),
    }, keys);
  }

  // ---- what there is

  get catalog() { return this.#catalog; }
  get cloud() { return this.#cloud; }
  get camera() { return this.#camera; }
  /** The camera, or, in flight, that which it will be. */
  get destination() { return this.#flight?.to ?? this.#camera; }
  /** All that is asked for, as the protocol has it. */
  get view() { return this.#exchange.wanted; }
  /** The part of the canvas that nothing lies over. */
  get #free() { return this.freeSize(this.#picture.cssSize); }
  /** Of all that is shown, where other clouds are shown with this one. */
  get bounds() { return boundsOf(this.#cloud, this.view.with, this.#catalog.clouds) ?? unitBox; }
  /** What is asked for, as restore() takes it - in flight, where that leads to; undefined where nothing is shown. */
  get place() {
    if (!this.#camera || !this.#cloud) return undefined;
    const camera = this.#flight?.to ?? this.#camera;
    return { cloud: this.#cloud.id, camera: wireOf(camera, this.bounds), upAxis: camera.upAxis, style: pick(this.view, styleKeys) };
  }
  /** Nobody has moved the camera or chosen a style: this is how the server shows the cloud. */
  get isUntouched() { return !this.#moved && !this.#styled; }
  /** Pixels of the picture. */
  get pictureSize() { return this.#picture.size; }
  /** Of the canvas, in CSS pixels, as cursors are. */
  get cssSize() { return this.#picture.cssSize; }
  /** From where what is on the canvas looks (pose.js), at every frame of the display; undefined where nobody knows. */
  get shownPose() { return this.#picture.shownPose; }
  /** What the newest picture has seen of the surface (seen.js). */
  get seen() { return this.#exchange.seen[0]; }
  /** Nothing has been drawn yet. */
  get isBlank() { return this.#picture.isBlank; }

  /** From where the server would look at the cloud; unless that is inside, fitted to this canvas. */
  usualCamera(of = this.#cloud, upAxis = usualUpAxis(of)) {
    const theirs = fromProtocol(of.view?.camera, usualUpAxis(of)) ?? fromProtocol({ eye: [1, -2, 1], target: [0, 0, 0] });
    const first = of.look?.views?.[0];
    const { cssSize } = this.#picture;
    if (!first || upAxis !== usualUpAxis(of)) return fit({ ...theirs, upAxis }, of.bounds ?? unitBox, cssSize, this.#free);
    if (first.inside) return theirs;
    const free = this.#free;
    return this.#firstViews.first(of, cssSize, free, upAxis) ?? fittedInto(theirs, cssSize, free);
  }

  /** The surface under a cursor, as far as the newest picture's depth tells: { point, depth }; undefined where there is none. */
  surfaceAt(cursor) {
    return this.#camera && surfaceUnder(this.seen, this.#camera, cursor, this.#picture.cssSize, this.bounds);
  }

  /**
   * The point of the scan that is seen under a cursor, as the protocol has it ("A picked point"); null where there is none. Of a cloud that is
   * shifted, `position` is where it is seen, as everything else is that is drawn there. Rejects with what the server refuses with.
   */
  async pickAt({ x, y }) {
    const { size: { width, height }, cssSize } = this.#picture;
    if (x < 0 || y < 0 || x >= cssSize.width || y >= cssSize.height || !this.pickable({ x, y })) return null;
    const scale = width / cssSize.width;
    const { cloud, ...view } = this.view;
    const found = await this.server.pick(cloud, { ...view, width, height }, { x: x * scale, y: y * scale });
    return found?.shift ? { ...found, position: found.position.map((value, axis) => Number((value + found.shift[axis]).toPrecision(15))) } : found;
  }

  // ---- what one may do

  /**
   * Connects, anew where it is connected. `restore`, { cloud, camera, upAxis, style }, each of which may be missing: what to
   * show first, the camera in the protocol's words, or some of them.
   */
  start(restore) {
    this.#next = undefined;
    this.#restore = restore;
    this.#flight = undefined;
    this.#isStopped = false;
    this.#session.start(restore?.cloud);
  }

  /** Ends the connection; start() makes another one. */
  stop() {
    clearTimeout(this.#nextList);
    this.#isStopped = true;
    this.#next = this.#flight = undefined;
    this.#session.stop();
  }

  retryNow() {
    this.#session.retryNow();
  }

  /** Asks once more for the list of clouds: `clouds` tells it. */
  refreshClouds() {
    return this.#session.refreshCatalog();
  }

  /** Goes out: as if nobody had ever given a token. */
  forgetToken() {
    this.#session.lock();
  }

  /** The server asked for an access token: here it is; `remember` keeps it on this device. */
  unlock(token, remember = false) {
    this.#session.unlock(token, remember);
  }

  /** Shows another cloud, as the server would show it; where it cannot be shown, `connection` tells why. */
  open(id) {
    this.#next = undefined;
    if (this.#isShown(id)) return;
    this.#tell('jump');
    const style = this.#styled && this.#cloud ? pick(this.view, lastingKeys) : {};
    if (this.#canShow(id)) this.#showSoon({ cloud: id, style });
    else {
      this.#tell('sought', { cloud: id });
      this.start({ cloud: id, style });
    }
  }

  /**
   * A view from elsewhere, { cloud, camera, upAxis, style }: a link, the browser's history. Of the style, what it leaves out
   * is as the server has it; a camera that it leaves out stays.
   */
  restore(link) {
    const id = link.cloud ?? this.#next?.cloud ?? this.#restore?.cloud ?? this.#cloud?.id;
    this.#next = undefined;
    if (!this.#isShown(id)) {
      if (this.#canShow(id)) this.#showSoon({ ...link, cloud: id });
      else this.start({ ...link, cloud: id });
      return;
    }
    const camera = link.camera && this.#cameraOf(link);
    if (camera) this.#flyTo(camera, 'program');
    this.changeStyle(restyled(usualStyle(this.#cloud), link.style), 'program');
  }

  #isShown(id) {
    return this.#session.connection !== undefined && this.#cloud !== undefined && id === this.#cloud.id;
  }

  #canShow(id) {
    return this.#session.connection !== undefined && this.#camera !== undefined && this.#catalog.clouds.some((one) => one.id === id);
  }

  /** Resolves when it is known how that cloud fills this canvas, or when that takes too long. */
  #expected(cloud) {
    const patience = new Promise((done) => { setTimeout(done, firstViewPatienceMs); });
    return Promise.race([this.#firstViews.load(cloud, this.#free), patience]);
  }

  /** As soon as it is known how that cloud fills this canvas; of two that are asked for at once, the last one. */
  async #showSoon(link) {
    this.#next = link;
    const find = () => this.#catalog.clouds.find((one) => one.id === link.cloud);
    await this.#expected(find());
    if (this.#next !== link) return;
    this.#next = undefined;
    if (this.#canShow(link.cloud)) this.#show(link, find());
    else this.start(link);
  }

  #show(link, cloud) {
    this.#flight = undefined;
    this.#cloud = cloud;
    this.#session.remember(link.cloud);
    const camera = link.camera && this.#cameraOf(link);
    this.#moved = Boolean(camera);
    this.#styled = Object.keys(link.style ?? {}).length > 0;
    this.#camera = camera ?? this.usualCamera();
    this.#begin(restyled(usualStyle(this.#cloud), link.style));
  }

  /** The camera that a link says, with the usual one for what it leaves out. */
  #cameraOf({ camera, upAxis }) {
    return cameraOf(camera, wireOf(this.usualCamera(), this.bounds), upAxis);
  }

  /** `changes`: members of a view that are no camera; null leaves one to the server. */
  changeStyle(changes, by = 'style') {
    if (!this.#cloud) return;
    this.#styled = true;
    this.#exchange.change(changes);
    if (changes.with !== undefined && this.#camera) { // without perspective, the eye stands before all that is shown
      this.#camera = { ...this.#camera };
      this.#exchange.change({ camera: wireOf(this.#camera, this.bounds) });
    }
    this.#tell('view', { by });
    this.#wake();
  }

  resetStyle() {
    this.changeStyle(usualStyle(this.#cloud));
  }

  changeCamera(next, by = 'hand') {
    if (!this.#camera || next === this.#camera) return;
    this.#moved = true;
    this.#flight = undefined;
    this.#camera = next;
    this.#steered = performance.now();
    this.#exchange.change({ camera: wireOf(next, this.bounds) });
    this.#tell('camera', { by });
    this.#tell('view', { by });
    this.#wake();
  }

  /** Nobody has moved, and the canvas is of another size: as the server would show the cloud in that. */
  async #refit() {
    const cloud = this.#cloud;
    if (!this.#camera || !cloud) return;
    await this.#firstViews.load(cloud, this.#free);
    if (this.#moved || this.#flight || cloud !== this.#cloud) return;
    this.#camera = this.usualCamera();
    this.#exchange.change({ camera: wireOf(this.#camera, this.bounds) });
    this.#tell('camera', { by: 'server' });
    this.#tell('view', { by: 'server' });
    this.#wake();
  }

  /** A jump, shown as a short flight so that one sees where it leads. */
  goTo(next, by = 'program') {
    if (!this.#camera) return;
    this.#tell('jump');
    this.#flyTo(next, by);
  }

  #flyTo(next, by) {
    this.#input.rest();
    if (this.#calm.matches) {
      this.changeCamera(next, by);
      return;
    }
    this.#flight = { from: this.#camera, to: next, start: performance.now(), by };
    this.#wake();
  }

  /** As the protocol has it: where a scanner stood, where a photo was taken. */
  goToPlace(place) {
    const next = fromProtocol(place, this.#camera?.upAxis ?? 'z');
    if (next && this.#camera) this.goTo(next);
  }

  /** One of the views that the cloud's look names, { camera, inside }: fitted to this canvas, unless it stands inside. */
  showView({ camera, inside }) {
    const next = fromProtocol(camera, this.#camera?.upAxis ?? 'z');
    if (!next || !this.#camera) return;
    this.goTo(inside ? next : fittedInto(next, this.#picture.cssSize, this.#free));
  }

  /** 'fit', 'first' (as the server would show it) or a name that standardView() knows: all of the cloud. */
  showStandardView(name) {
    if (!this.#camera || !this.#cloud) return;
    const room = [this.bounds, this.#picture.cssSize, this.#free];
    if (name === 'first') this.goTo(this.usualCamera(this.#cloud, this.#camera.upAxis));
    else this.goTo(name === 'fit' ? this.#everything(room) : standardView(this.#camera, name, ...room));
  }

  /** As a plan has it: all of the cloud without perspective from there, a name that standardView() knows. */
  showPlan(name) {
    if (!this.#camera || !this.#cloud) return;
    this.goTo(standardView({ ...this.#camera, projection: 'orthographic' }, name, this.bounds, this.#picture.cssSize, this.#free));
  }

  /** Towards what is in the middle of the picture, or away from it. */
  goToMiddle(away = false) {
    this.#input.goToMiddle(away);
  }

  /** 'z', 'y' or '-y': from where the server would look, if that axis were up. */
  turnUp(axis) {
    if (!this.#cloud) return;
    this.#tell('jump');
    this.changeCamera(this.usualCamera(this.#cloud, axis));
  }

  toggleProjection() {
    if (!this.#camera) return;
    const projection = this.#camera.projection === 'orthographic' ? 'perspective' : 'orthographic';
    const flight = this.#flight;
    this.changeCamera({ ...this.#camera, projection });
    if (flight) this.#flyTo({ ...flight.to, projection }, flight.by); // it is to arrive all the same
  }

  // ---- inside

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /** All of the cloud from the direction that the camera has: as at first, where that is the first one. */
  #everything(room) {
    const first = this.usualCamera(this.#cloud, this.#camera.upAxis);
    const isFirst = !this.view.with && ['azimuth', 'elevation', 'fov', 'projection'].every((key) => first[key] === this.#camera[key]);
    return isFirst ? first : fit(this.#camera, ...room);
  }

  #catalogCame(fresh) {
    this.#catalog = fresh;
    this.#tell('catalog', fresh);
    this.#askAgainWhileLoading();
  }

  #cloudsCame(fresh) {
    this.#catalog = { ...this.#catalog, ...fresh };
    this.#tell('clouds', this.#catalog);
    this.#renew();
    this.#askAgainWhileLoading();
  }

  #askAgainWhileLoading() {
    const { clouds, pending } = this.#catalog;
    clearTimeout(this.#nextList);
    if (this.#isStopped) return;
    if ([...clouds, ...pending].some((entry) => entry.state === 'loading'))
      this.#nextList = setTimeout(async () => {
        await this.refreshClouds();
        this.#askAgainWhileLoading(); // also where that failed
      }, loadingPollMs);
  }

  #welcome(message) {
    const known = this.#cloud?.id === message.cloud;
    this.#cloud = this.#catalog.clouds.find((one) => one.id === message.cloud) ?? { id: message.cloud, bounds: unitBox, view: message.view };
    this.#movingFrames.begin(message);
    this.#picture.newStream();
    this.#picture.setLimit(message.limits?.maxPixels ?? 0);
    const link = this.#restore;
    this.#restore = undefined;
    const restored = link && (!link.cloud || link.cloud === this.#cloud.id) ? link : undefined;
    if (restored || !known || !this.#camera) {
      const camera = restored?.camera && this.#cameraOf(restored);
      this.#moved = Boolean(camera);
      this.#styled = Object.keys(restored?.style ?? {}).length > 0;
      this.#camera = camera ?? this.usualCamera();
    }
    const style = known && !restored ? pick(this.view, styleKeys) : usualStyle(this.#cloud);
    this.#begin(restyled(style, restored?.style));
  }

  /** The cloud as it is now, of which a first part was shown; who has not moved yet sees it as the server would show it. */
  async #renew() {
    const find = () => this.#catalog.clouds.find((one) => one.id === this.#cloud?.id);
    if (!find() || find().revision === this.#cloud.revision) return;
    if (this.isUntouched) await this.#firstViews.load(find(), this.#free);
    const fresh = find();
    if (!fresh || fresh.revision === this.#cloud.revision) return; // it went on meanwhile
    this.#cloud = fresh;
    if (this.#moved || this.#styled) {
      this.#tell('cloud', fresh);
      this.#wake(); // it may know more columns now
      return;
    }
    this.#camera = this.usualCamera();
    this.#begin(usualStyle(fresh));
  }

  /** From here on the server shows this cloud, with that style, from where the camera is. */
  #begin(style) {
    const { width, height } = this.#picture.size;
    const view = { cloud: this.#cloud.id, camera: wireOf(this.#camera, this.bounds), width, height, ...style };
    this.#exchange.begin(view, this.#session.connection?.nextSeq ?? 0);
    this.#input.rest();
    this.#tell('begin');
    this.#tell('cloud', this.#cloud);
    this.#tell('view', { by: 'server' });
    this.#wake();
  }

  // One tick for each frame of the display.

  #wake() {
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame((now) => this.#tick(now));
  }

  #tick(now) {
    this.#scheduled = false;
    const seconds = Math.min(0.1, Math.max(0, (now - this.#lastTick) / 1000));
    this.#lastTick = now;
    if (this.#flight) this.#fly();
    else if (this.#input.isMoving && this.#camera) this.changeCamera(this.#input.advance(this.#camera, seconds, now));
    this.#send();
    this.#reproject();
    const isOwed = this.#session.connection && (this.#isSteered || this.#exchange.hasNews);
    if (this.#flight || this.#input.isMoving || isOwed) this.#wake();
  }

  get #isSteered() {
    return performance.now() - this.#steered < (this.#input.isHeld ? restMs.held : restMs.free);
  }

  /** While the picture from here is on its way, the last one as it would look from here. */
  #reproject() {
    if (this.#camera && this.#session.connection && !this.#calm.matches) this.#picture.lookFrom(this.#camera, this.bounds);
    else this.#picture.showItself();
    this.#tell('shown');
  }

  #fly() {
    const { from, to, start, by } = this.#flight;
    const t = Math.min(1, (performance.now() - start) / flightMs);
    const smooth = t * t * (3 - 2 * t);
    const going = t < 1 ? this.#flight : undefined;
    this.changeCamera(t < 1 ? between(from, to, smooth) : to, by);
    this.#flight = going;
  }

  #send() {
    const { connection } = this.#session;
    if (!connection || !this.#camera) return;
    const seq = this.#exchange.send(connection, this.#camera, this.#isSteered && !this.#calm.matches);
    if (seq !== undefined) this.#tell('asked', { seq });
  }

  // What comes back.

  async #showFrame(frame) {
    const { connection } = this.#session;
    const bitmap = this.#movingFrames.decode(frame);
    try {
      const shown = await this.#exchange.show({ ...frame, bitmap }, this.bounds);
      if (shown) {
        this.#reproject();
        this.#tell('frame', { ...frame, current: frame.seq === connection?.nextSeq - 1 && shown.exact, movingFrames: this.#movingFrames.now });
      }
    } catch {
      if (!bitmap) this.#tell('unreadable'); // else JPEG is on its way
    }
    // Only now, so that a slow machine is not sent more than it can decode.
    connection?.acknowledge(frame.frameId);
  }

  #refused(message) {
    const { seq } = message;
    if (this.#exchange.refusedMargin(seq)) {
      this.#wake();
      return;
    }
    this.#tell('problem', message.problem);
    if (seq === undefined || !this.#cloud) return;
    const sound = { ...this.view, ...usualStyle(this.#cloud), camera: wireOf(this.usualCamera(), this.bounds) };
    if (!this.#exchange.refused(seq, sound)) return;
    this.#cloud = this.#catalog.clouds.find((one) => one.id === this.view.cloud) ?? this.#cloud;
    this.#camera = cameraOf(this.view.camera, undefined, this.#camera.upAxis) ?? this.#camera;
    this.#tell('cloud', this.#cloud);
    this.#tell('view', { by: 'server' });
    this.#wake();
  }
}
