// What the page says of cutting by boxes. strings.js puts it beside the rest, as strings.clip.

export const clip = {
  tool: 'Cut',
  toolTip: 'Cut the scan by boxes (X)',
  title: 'Cut',
  close: 'Close cutting',
  how: 'Draw a face, the middle, or the arm that turns a box.',
  list: 'What cuts',
  empty: 'Nothing is cut.',
  add: 'Add a box',
  none: 'Cut nothing',
  box: (number) => `Box ${number}`,
  plane: (number) => `Plane ${number}`,
  keep: 'What is shown',
  keeps: { inside: 'What is inside', outside: 'What is outside' },
  center: 'Centre',
  size: 'Size',
  turn: 'Turn °',
  flip: 'Other side',
  remove: 'Remove',
};
