// What the page says of annotations.

const pressed = (touch) => (touch ? 'Tap' : 'Click');

export const annotate = {
  title: 'Notes',
  close: 'Close notes',
  how: (touch) => `${pressed(touch)} a point of the scan to put a note there.`,
  keys: 'Space takes the point in the middle of the picture.',
  again: (name, touch) => `${pressed(touch)} where “${name}” is to be.${touch ? '' : ' Esc leaves it where it is.'}`,
  list: 'Notes',
  none: 'There are no notes yet.',
  first: 'Note', // "Note 1" is a note's first title
  show: (name) => `Show ${name}`,
  showTip: 'Show or hide it in the picture',
  name: 'Title',
  text: 'Text',
  link: 'Link',
  linkHint: 'https://',
  linkRefused: 'A link begins with http:// or https://.',
  follow: 'Open link',
  move: 'Move',
  moveTip: 'Move the note to another point',
  zoom: 'Zoom to',
  remove: 'Delete',
  undo: 'Undo',
  undoTip: 'Take back the last change (Ctrl+Z)',
  redo: 'Redo',
  redoTip: 'Do it again (Ctrl+Shift+Z)',
  files: 'Save and export',
  saveProject: 'Save project',
  saveProjectTip: 'View, measurements, notes, saved views and tours as a file that this page opens again',
  openProject: 'Open project…',
  openProjectTip: 'A project file; it can also be dropped onto the picture',
  exports: 'Tables and maps of the notes come with the measurements’: Measure, Save and export.',
  said: { placed: (name, place) => `${name}: ${place}`, removed: (name) => `${name} deleted` },
  messages: { tooMany: 'There are too many notes', tooManyDetail: (most) => `${most} is the most. Save the project, and delete some.` },
};
