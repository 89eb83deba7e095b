// Rows of a card's list (styles/card.css, `entries`): their buttons, whose keys say which one had the focus when a list is made anew, and their heads.

import { icon } from '../icons.js';
import { element } from '../parameter_fields.js';

/** A button that focusOn() finds by its key. */
export function keyed(key, properties, act) {
  const button = element('button', { type: 'button', ...properties });
  button.dataset.key = key;
  button.addEventListener('click', act);
  return button;
}

/** Gives the focus to what has that key in a list; whether there is such a thing. */
export function focusOn(list, key) {
  const found = list.querySelector(`[data-key="${CSS.escape(key)}"]`);
  found?.focus({ preventScroll: false });
  return Boolean(found);
}

/** The head of a row: an eye, and the name that opens it; `words`: { showTip, show(name) }; `does`: { show(isShown), open() }. */
export function headOf({ id, name, visible }, isOpen, words, does, ...more) {
  const head = keyed(`row-${id}`, { className: 'name', ariaExpanded: String(isOpen) }, does.open);
  head.append(element('span', { textContent: name }), ...more);
  const eye = keyed(`eye-${id}`, { className: 'eye', title: words.showTip ?? '', ariaLabel: words.show(name), ariaPressed: String(visible) }, () => does.show(!visible));
  eye.append(icon(visible ? 'shown' : 'unshown'));
  return element('div', { className: 'head' }, eye, head);
}

/** Escape leaves a text field, which keeps what was written, for the row that it stands in. */
export function leavesByEscape(field, leave) {
  field.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || event.isComposing) return;
    event.preventDefault();
    event.stopPropagation();
    field.blur();
    leave();
  });
  return field;
}
