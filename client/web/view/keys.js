// Which keys steer the view, and whether a key that was pressed is the view's at all: text fields keep theirs, and menus
// and sliders the few that work them. Pure but for asking elements what they are.

/** Keys that act while they are held, by their place on the keyboard, whatever letter stands there - but for + and -. */
export const heldKeys = {
  KeyW: { ahead: 1 }, KeyS: { ahead: -1 },
  KeyA: { right: -1 }, KeyD: { right: 1 },
  KeyE: { up: 1 }, KeyQ: { up: -1 },
  PageUp: { up: 1 }, PageDown: { up: -1 },
  ArrowLeft: { turn: -1 }, ArrowRight: { turn: 1 },
  ArrowUp: { tilt: 1 }, ArrowDown: { tilt: -1 },
  Plus: { zoom: 1 }, Minus: { zoom: -1 },
};

/** For the help: what every key does, those of main.js included. */
export const keyTable = [
  ['W A S D', 'walk or fly; the wheel changes the speed'],
  ['Q E', 'down and up'],
  ['Shift', 'hold to go faster'],
  ['C', 'stop at surfaces, or pass through them'],
  ['← → ↑ ↓', 'orbit, or look around'],
  ['Shift ← →', 'pan'],
  ['+ −', 'zoom in and out'],
  ['Enter', 'go to the middle (with Shift: away)'],
  ['F', 'fit everything'],
  ['Home', 'the first view'],
  ['1 2 3', 'from the top, the front, the right'],
  ['4 5 6', 'from the back, the left, below'],
  ['7', 'plan: from the top, orthographic; back'],
  ['G N', 'grid; overview map'],
  ['L', 'switch dragging between orbit and look around'],
  ['O', 'perspective or orthographic'],
  ['M', 'measure; then Space takes the point in the middle'],
  ['B', 'filter by values'],
  ['U', 'show other clouds together'],
  ['X', 'cut by boxes'],
  ['T', 'profile along a line'],
  ['I', 'notes'],
  ['V J', 'suggested and saved views; play a tour'],
  ['K', 'compare two methods, colourings or clouds'],
  ['H', 'presentation: the picture and nothing else'],
  ['Ctrl Z', 'previous view (with Shift: the next)'],
  ['P', 'settings'],
  ['?', 'this help'],
];

const signs = { '+': 'Plus', '=': 'Plus', '-': 'Minus', '−': 'Minus' };
export const placeOf = (event) => signs[event.key] ?? event.code;

const notTyped = ['button', 'checkbox', 'color', 'file', 'image', 'radio', 'range', 'reset', 'submit'];
const isTextField = (element) =>
  element.closest('textarea, [contenteditable=""], [contenteditable="true"]') !== null ||
  (element.localName === 'input' && !notTyped.includes(element.type));

/** Keys that work a menu, a slider or a group of buttons themselves. */
const worksFields = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End', 'PageUp', 'PageDown', 'Enter', ' '];
const fields = 'select, input, [role="slider"], [role="radio"], [role="tab"], [role="menuitem"], [role="option"]';
const buttons = 'button, a, summary';
const worksButtons = ['Enter', ' '];

/** A menu that is open has all keys. Browsers that cannot tell say no. */
function isOpenMenu(element) {
  try {
    return element.matches('select:open');
  } catch {
    return false;
  }
}

/** Whether this key, pressed while `event.target` has the focus, is the view's: nobody else has made use of it, or would. */
export function isForView(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.isComposing || event.defaultPrevented) return false;
  const { target, key } = event;
  if (typeof target?.closest !== 'function') return true;
  if (target.closest('dialog, [data-own-keys]') || isTextField(target) || isOpenMenu(target)) return false;
  if (target.closest(fields)) return !worksFields.includes(key);
  return !target.closest(buttons) || !worksButtons.includes(key);
}
