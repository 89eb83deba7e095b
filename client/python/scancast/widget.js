// The notebook's half of scancast.Cloud.widget(): an anywidget module that puts the server's own <scancast-view> into a cell, and
// keeps it and the Python object the same.
//
// The model's traits: _server, _locked, _asked [number, words], _shown (a view as JSON), cloud, controls, height, picked, status.
// An access token comes by a message when it is asked for, never as a trait: traits are saved with notebooks.

const quietMs = 150; // a drag tells Python so often
const steadyPx = 4; // a press that moves farther is a drag
const tokenMs = 10_000; // Python is asked for a token so often at most: one that is refused is refused again

/** What is said where the server does not let this page in, which a browser does not tell from its being away. */
const unreachable = (server, origin) => `The view cannot be loaded from ${server}. If the server is up, it does not know this notebook's address: `
  + `start it with --allowed-origin ${origin}`;

/** Calls `act` now, and while calls go on no more often than every `ms`; the last one is never lost. */
export function unhurried(act, ms) {
  let timer;
  let again = false;
  const run = () => {
    again = false;
    timer = setTimeout(() => {
      timer = undefined;
      if (again) run();
    }, ms);
    act();
  };
  const call = () => {
    if (timer === undefined) run();
    else again = true;
  };
  call.stop = () => clearTimeout(timer);
  return call;
}

/** In the view's place, where this page cannot reach the server and Python can: still pictures that Python draws, and why. */
function stills(model, box, say, why) {
  box.style.height = 'auto';
  const note = document.createElement('p');
  note.textContent = `${why}. Until then, Python draws: the picture follows show(), not the hand.`;
  const image = document.createElement('img');
  image.style.maxWidth = '100%';
  image.alt = '';
  box.append(note, image);
  say(why);
  let shown;
  const ask = () => model.send({ type: 'still', width: Math.round(Math.min(1920, Math.max(320, box.clientWidth || 640))), height: model.get('height') });
  const take = (message, buffers) => {
    if (message?.type !== 'still' || !buffers?.[0]) return;
    URL.revokeObjectURL(shown);
    shown = URL.createObjectURL(new Blob([buffers[0]], { type: 'image/jpeg' }));
    image.src = shown;
  };
  const changes = { 'change:_asked': ask, 'change:cloud': ask, 'change:height': ask, 'msg:custom': take };
  for (const [event, act] of Object.entries(changes)) model.on(event, act);
  ask();
  return () => {
    for (const [event, act] of Object.entries(changes)) model.off(event, act);
    URL.revokeObjectURL(shown);
    box.remove();
  };
}

async function render({ model, el }) {
  const server = model.get('_server');
  const box = document.createElement('div');
  box.className = 'scancast';
  const fit = () => { box.style.height = `${model.get('height')}px`; };
  fit();
  el.append(box);
  const say = (text) => {
    if (model.get('status') === text) return;
    model.set('status', text);
    model.save_changes();
  };
  try {
    await import(/* webpackIgnore: true */ new URL('scancast-view.js', server).href);
  } catch {
    return stills(model, box, say, unreachable(server, location.origin));
  }

  const view = document.createElement('scancast-view');
  view.style.height = '100%';
  view.setAttribute('src', server);
  view.setAttribute('cloud', model.get('cloud'));
  view.setAttribute('controls', model.get('controls'));
  const [, words] = model.get('_asked');
  if (words) view.setAttribute('view', words);

  // From the view to Python.
  const tell = unhurried(() => {
    if (!view.viewer.cloud || !view.viewer.view.camera) return; // nothing to look at yet
    const { ratio, width, height, ...shown } = JSON.parse(JSON.stringify(view.viewer.view));
    model.set('_shown', shown);
    if (view.cloud && model.get('cloud') !== view.cloud) model.set('cloud', view.cloud);
    model.save_changes();
  }, quietMs);
  view.addEventListener('viewchange', tell);
  view.addEventListener('cloudchange', tell);
  let askedAt = -Infinity;
  view.addEventListener('connection', ({ detail }) => {
    if (detail.kind === 'locked' && model.get('_locked') && performance.now() - askedAt > tokenMs) {
      askedAt = performance.now();
      model.send({ type: 'token' });
    }
    say(detail.kind === 'open' ? '' : [detail.kind, detail.detail].filter(Boolean).join(': '));
  });
  view.addEventListener('problem', ({ detail }) => say(detail.detail ?? detail.title ?? ''));
  let pressed = [0, 0];
  view.addEventListener('pointerdown', ({ clientX, clientY }) => { pressed = [clientX, clientY]; });
  view.addEventListener('click', async ({ clientX, clientY, offsetX, offsetY }) => {
    if (Math.hypot(clientX - pressed[0], clientY - pressed[1]) > steadyPx) return;
    try {
      model.set('picked', await view.pick(offsetX, offsetY));
      model.save_changes();
    } catch (error) {
      say(String(error.message ?? error));
    }
  });

  // From Python to the view.
  const changes = {
    'change:_asked': () => { view.view = model.get('_asked')[1]; },
    'change:cloud': () => { if (view.cloud !== model.get('cloud')) view.cloud = model.get('cloud'); },
    'change:controls': () => { view.controls = model.get('controls'); },
    'change:height': fit,
    'msg:custom': (message) => {
      if (message?.type === 'token' && typeof message.token === 'string') view.token = message.token;
      else if (message?.type === 'fit') view.fit();
      else if (message?.type === 'standard' && typeof message.name === 'string') view.showStandardView(message.name);
    },
  };
  for (const [event, act] of Object.entries(changes)) model.on(event, act);
  box.append(view);
  return () => {
    for (const [event, act] of Object.entries(changes)) model.off(event, act);
    tell.stop();
    box.remove();
  };
}

export default { render };
