// Where the panel is: a column of its own beside the picture, or, in a small window that stands upright, a sheet of three heights
// under it. The picture ends where either begins; styles/panel.css does that, this keeps what is open and how high.

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
/** There is no room for a column beside a picture of some size: it opens only when it is asked for. */
const small = '(max-width: 999px), (max-height: 480px)';
/** The same as in styles/panel.css. */
const asSheet = '(max-width: 760px) and (orientation: portrait), (max-width: 480px)';

/** Heights of the sheet, the lowest first, as parts of the window: the choice of cloud and appearance; half; nearly all. */
export const sheetHeights = { peek: 0.27, half: 0.5, full: 0.92 };

/** The height that is nearest to this part of the window; undefined below half of the lowest: then it is to be closed. Pure. */
export function nearestHeight(part) {
  if (part < sheetHeights.peek / 2) return undefined;
  const distance = (name) => Math.abs(sheetHeights[name] - part);
  return Object.keys(sheetHeights).reduce((best, name) => (distance(name) < distance(best) ? name : best));
}

export class Layout {
  #small = matchMedia(small);
  #asSheet = matchMedia(asSheet);
  #openWhenLarge = true;

  constructor() {
    find('toggle-panel').addEventListener('click', () => this.toggle());
    find('close-panel').addEventListener('click', () => {
      this.show(false);
      find('toggle-panel').focus();
    });
    // What was open beside the picture would be all of a smaller window.
    this.#small.addEventListener('change', () => this.#place(!this.#small.matches && this.#openWhenLarge));
    this.#place(!this.#small.matches);
    this.#sheet('half');
    this.#dragHandle();
  }

  get isOpen() {
    return !document.body.classList.contains('panel-closed');
  }

  toggle() {
    this.show(!this.isOpen);
  }

  show(open) {
    if (!this.#small.matches) this.#openWhenLarge = open;
    this.#place(open);
  }

  #place(open) {
    document.body.classList.toggle('panel-closed', !open);
    find('toggle-panel').setAttribute('aria-expanded', String(open));
  }

  #sheet(height) {
    document.body.dataset.sheet = height;
  }

  #dragHandle() {
    const handle = find('sheet-handle');
    const names = Object.keys(sheetHeights);
    const step = (by) => {
      const at = names.indexOf(document.body.dataset.sheet) + by;
      this.#sheet(names[Math.min(names.length - 1, Math.max(0, at))]);
    };
    let from; // where the finger came down, and whether it has moved since
    handle.addEventListener('pointerdown', (event) => {
      if (!this.#asSheet.matches) return;
      handle.setPointerCapture(event.pointerId);
      from = { y: event.clientY, height: find('panel').offsetHeight, moved: false };
    });
    handle.addEventListener('pointermove', (event) => {
      if (!from) return;
      from.moved ||= Math.abs(event.clientY - from.y) > 6;
      if (from.moved) find('panel').style.setProperty('height', `${Math.max(60, from.height + from.y - event.clientY)}px`);
    });
    const end = () => {
      if (!from) return;
      const { moved } = from;
      from = undefined;
      if (!moved) return;
      const height = nearestHeight(find('panel').offsetHeight / innerHeight);
      find('panel').style.removeProperty('height');
      if (height) this.#sheet(height);
      else this.show(false);
      suppressed = true;
      setTimeout(() => { suppressed = false; });
    };
    let suppressed = false; // the click that ends a drag
    handle.addEventListener('pointerup', end);
    handle.addEventListener('pointercancel', end);
    handle.addEventListener('click', () => {
      if (suppressed) return;
      if (document.body.dataset.sheet === 'full') this.#sheet('peek');
      else step(1);
    });
    handle.addEventListener('keydown', (event) => {
      if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
      event.preventDefault();
      event.stopPropagation(); // else the camera turns
      step(event.key === 'ArrowUp' ? 1 : -1);
    });
  }
}
