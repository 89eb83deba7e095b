// The list of notes in their card: titles, texts and links as fields, so that keys and screen readers reach all of it.

import { placeText } from '../measure/units.js';
import { focusOn, headOf, keyed, leavesByEscape } from '../page/cards/entries.js';
import { icon } from '../page/icons.js';
import { element } from '../page/parameter_fields.js';
import { annotate as words } from '../page/strings/annotate.js';
import { linkOf, longestLink, longestText, longestTitle } from './notes.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const touch = matchMedia('(pointer: coarse)');

export class NoteList {
  #notes;
  #does;
  #rows = new Map(); // id → { note, isOpen, row }
  #said; // what show() was told last
  #edited; // id of the note in whose fields the focus is: while it goes from one to the next, nothing has it

  /** `does`: select(id or undefined), again(id), zoom(id), remove(id), save(), open(). */
  constructor(notes, does) {
    this.#notes = notes;
    this.#does = does;
    const on = (id, act) => find(id).addEventListener('click', act);
    on('note-undo', () => notes.undo());
    on('note-redo', () => notes.redo());
    on('note-save-project', () => does.save());
    on('note-open-project', () => does.open());
    // What is being written is kept also where the page is left.
    const hold = () => {
      const field = /** @type {any} */ (document.activeElement);
      if (field?.closest?.('#note-list') && field.matches('input, textarea')) field.dispatchEvent(new Event('change'));
    };
    addEventListener('pagehide', hold);
    document.addEventListener('visibilitychange', () => document.hidden && hold());
    find('note-undo').append(icon('undo'));
    find('note-redo').append(icon('redo'));
  }

  /** For screen readers. */
  say(text) {
    find('note-said').textContent = text;
  }

  show(said) {
    this.#said = said;
    const { selected, replaced, cloud } = said;
    const { list } = this.#notes;
    const moving = this.#notes.find(replaced);
    find('note-how').textContent = moving ? words.again(moving.name, touch.matches) : [words.how(touch.matches), touch.matches ? '' : words.keys].filter(Boolean).join(' ');
    find('note-none').hidden = list.length > 0;
    find('note-list').hidden = list.length === 0;
    find('note-undo').disabled = !this.#notes.canUndo;
    find('note-redo').disabled = !this.#notes.canRedo;
    /** @type {any} */
    const active = document.activeElement;
    const focused = active?.closest?.('#note-list') && active.dataset.key;
    const before = this.#rows;
    this.#rows = new Map(list.map((note) => [note.id, this.#kept(before.get(note.id), note, note.id === selected) ?? { note, isOpen: note.id === selected, row: this.#row(note, note.id === selected, cloud) }]));
    const rows = [...this.#rows.values()].map(({ row }) => row);
    const shown = [...find('note-list').children];
    // What is there already is not touched: whoever goes from field to field would lose his way.
    if (rows.length !== shown.length || rows.some((row, i) => row !== shown[i])) find('note-list').replaceChildren(...rows);
    // What had the focus may be gone; then the next best has it, and never nothing.
    if (focused && document.activeElement !== active && !focusOn(find('note-list'), focused)) (find('note-list').querySelector('button') ?? find('close-annotating')).focus();
  }

  /** The row of a note, where it still says what is so, or where somebody is writing in it. */
  #kept(known, note, isOpen) {
    if (!known || known.isOpen !== isOpen) return undefined;
    if (known.note !== note && !(isOpen && this.#edited === note.id)) return undefined;
    known.row.querySelector('.name span').textContent = note.name;
    return known;
  }

  /** Its title is what one writes next. */
  edit(id) {
    if (touch.matches) return; // where fields bring a keyboard that covers what was pointed at
    focusOn(find('note-list'), `name-${id}`);
    find('note-list').querySelector(`[data-key="name-${id}"]`)?.select();
  }

  #row(note, isOpen, cloud) {
    const { id, visible } = note;
    const head = headOf(note, isOpen, words, { show: (isShown) => this.#notes.change(id, { visible: isShown }), open: () => this.#does.select(isOpen ? undefined : id) });
    const row = element('li', { className: visible ? '' : 'unshown' }, head);
    if (isOpen) {
      const details = this.#details(note, cloud);
      details.addEventListener('focusin', () => { this.#edited = id; });
      details.addEventListener('focusout', ({ relatedTarget }) => {
        if (details.contains(relatedTarget)) return;
        this.#edited = undefined;
        if (this.#notes.find(id) !== this.#rows.get(id)?.note) queueMicrotask(() => this.show(this.#said)); // now it may be made anew
      });
      row.append(details);
    }
    return row;
  }

  #field(tag, key, label, value, longest, change) {
    const field = element(tag, { value, maxLength: longest, autocomplete: 'off', ...(tag === 'input' ? { type: 'text' } : { rows: 3 }), placeholder: key.startsWith('link') ? words.linkHint : '' });
    field.dataset.key = key;
    field.addEventListener('change', () => change(field.value, field));
    leavesByEscape(field, () => focusOn(find('note-list'), key.replace(/^\w+/, 'row')));
    return element('label', { className: 'field-of-note' }, element('span', { textContent: label }), field);
  }

  #details({ id, name, text, link, point, step }, cloud) {
    const refusal = element('p', { className: 'note warning', textContent: words.linkRefused, hidden: true });
    const change = (changes) => this.#notes.change(id, changes);
    const address = linkOf(link);
    const follow = address && element('a', { href: address, target: '_blank', rel: 'noopener noreferrer', textContent: words.follow });
    return element('div', { className: 'details' },
      this.#field('input', `name-${id}`, words.name, name, longestTitle, (value) => change({ name: value.trim() || name })),
      this.#field('textarea', `text-${id}`, words.text, text, longestText, (value) => change({ text: value })),
      this.#field('input', `link-${id}`, words.link, link, longestLink, (value, field) => {
        const trimmed = value.trim();
        refusal.hidden = trimmed === '' || linkOf(trimmed) !== undefined;
        field.setAttribute('aria-invalid', String(!refusal.hidden));
        if (refusal.hidden) change({ link: trimmed });
      }),
      refusal,
      ...(follow ? [follow] : []),
      element('p', { className: 'note', textContent: [placeText(point, step), cloud?.crsName ?? ''].filter(Boolean).join(' · ') }),
      element('div', { className: 'buttons' },
        keyed(`zoom-${id}`, { textContent: words.zoom }, () => this.#does.zoom(id)),
        keyed(`again-${id}`, { textContent: words.move, title: words.moveTip }, () => this.#does.again(id)),
        keyed(`remove-${id}`, { textContent: words.remove }, () => this.#does.remove(id))));
  }
}
