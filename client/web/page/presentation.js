// Presentation mode: the picture and nothing else but the scan's title and whose it is. H or a button enters, H or Escape
// leaves; `#present` in the address begins with it. In full screen where the browser lets us.

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const stirMs = 2500;
const word = 'present';

/** Whether an address's hash asks for it: `present`, or `present=true`, among its words. Pure. */
export const asksToPresent = (hash) => hash.replace(/^#/, '').split('&').some((part) => part === word || part === `${word}=true`);

export class Presentation {
  #stirred;
  /** @type {(on: boolean) => void} */
  #change;

  /** `change(on)` hears of it. */
  constructor(change) {
    this.#change = change;
    find('leave-presentation').addEventListener('click', () => this.leave());
    // Escape leaves full screen without telling the page about the key.
    document.addEventListener('fullscreenchange', () => {
      if (!document.fullscreenElement && this.isOn) this.leave();
    });
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && this.isOn && !document.querySelector('dialog[open]')) this.leave();
    });
    for (const name of ['pointermove', 'pointerdown', 'focusin']) addEventListener(name, () => this.#stir(), { passive: true });
  }

  get isOn() {
    return document.body.classList.contains('presenting');
  }

  toggle() {
    if (this.isOn) this.leave();
    else this.enter();
  }

  /** `fullScreen`: only a click or a key may ask for that. */
  enter({ fullScreen = true } = {}) {
    document.body.classList.add('presenting');
    find('views-gallery').hidePopover();
    find('leave-presentation').hidden = false;
    find('picture').focus({ preventScroll: true, focusVisible: false });
    this.#change(true);
    // Refused on some phones, and where an embedding page does not allow it: the window has to do then.
    if (fullScreen) document.documentElement.requestFullscreen?.().then(() => {
      if (!this.isOn) document.exitFullscreen(); // left again meanwhile
    }).catch(() => {});
  }

  leave() {
    document.body.classList.remove('presenting', 'stirred');
    find('leave-presentation').hidden = true;
    find('picture').focus({ preventScroll: true, focusVisible: false });
    this.#change(false);
    if (document.fullscreenElement) document.exitFullscreen().catch(() => {});
  }

  /** The way out is shown while a hand moves. */
  #stir() {
    if (!this.isOn) return;
    document.body.classList.add('stirred');
    clearTimeout(this.#stirred);
    this.#stirred = setTimeout(() => document.body.classList.remove('stirred'), stirMs);
  }
}
