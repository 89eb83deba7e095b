// What the page says of cutting by boxes; loaded with it.

export const clip = {
  title: 'Cut',
  close: 'Close cutting',
  how: 'Draw a face, the middle, or the arm that turns a box. Of a half-space, the arm points to what is shown.',
  list: 'What cuts',
  empty: 'Nothing is cut.',
  add: 'Add a box',
  addPlane: 'Add a half-space',
  none: 'Cut nothing',
  box: (number) => `Box ${number}`,
  plane: (number) => `Half-space ${number}`,
  keep: 'What is shown',
  keeps: { inside: 'What is inside', outside: 'What is outside' },
  center: 'Centre',
  size: 'Size',
  turn: 'Turn °',
  point: 'Point',
  normal: 'Normal',
  flip: 'Other side',
  remove: 'Remove',
};
