// What the page says of filters by values; loaded with them.

export const filter = {
  title: 'Filter by values',
  close: 'Close the filters',
  how: 'Draw the handles together: only points whose values lie between them are shown.',
  list: 'Values of this scan',
  none: 'Show all points',
  state: (count, most) => (count === 0 ? '' : count < most ? `${count} of ${most} filters` : `${most} filters: these are the most`),
  waiting: 'What this scan keeps is known once it has been read.',
  nothing: 'This scan keeps no values to filter by. Read it again with --keep-attributes.',
  noHistogram: 'How its values are spread is not known here.',
  color: 'Colour',
  colorTip: (name) => `Colour by ${name}`,
  ramp: 'Ramp',
  low: (name) => `${name}: least value`,
  high: (name) => `${name}: greatest value`,
  rampOf: (name) => `Ramp over ${name}`,
  reset: 'All',
  resetLabel: (name) => `${name}: all values`,
};
