// What the page says about plans: classes, the legend, and what stands on the picture as it stands on a drawing. Part of strings.js,
// where the rules for these words are.

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

export const planStrings = {
  classes: {
    title: 'Classes',
    list: 'Classes in this scan',
    named: (name) => capital(name),
    number: (number) => `Class ${number}`,
    numbered: (name, number) => `${capital(name)} (${number})`,
    all: 'All',
    allTip: 'Show all classes',
    none: 'None',
    noneTip: 'Hide all classes',
    only: 'Only',
    onlyNamed: (name) => `Only ${name}`,
    points: (count) => `${count.toLocaleString('en')} ${count === 1 ? 'point' : 'points'}`,
    shown: (count, all) => (count === all ? `All ${all} are shown` : `${count} of ${all} are shown`),
  },

  onPicture: {
    title: 'On the picture',
    cube: 'View cube',
    scaleBar: 'Scale bar',
    legend: 'Legend',
    grid: 'Grid with coordinates (G)',
    minimap: 'Overview map (N)',
    gridNote: 'The grid is shown in plans: from the top or from a side, in orthographic projection.',
  },

  cube: {
    faces: { top: 'Top', bottom: 'Bottom', front: 'Front', back: 'Back', side: 'Right', left: 'Left' },
    compass: { front: 'S', back: 'N', side: 'E', left: 'W' },
    tip: 'Click a face, an edge or a corner to look from there',
    label: (from) => `View cube: seen from ${from}. Arrow keys turn it, Home looks from the top.`,
    above: 'above',
    below: 'below',
    fromSide: (side, height) => (height ? `${side}, ${height}` : side),
    sides: ['the right', 'the back right', 'the back', 'the back left', 'the left', 'the front left', 'the front', 'the front right'],
    winds: ['the east', 'the north-east', 'the north', 'the north-west', 'the west', 'the south-west', 'the south', 'the south-east'],
    north: 'N',
    plan: 'Plan',
    planTip: 'Plan: everything from the top, in orthographic projection; once more leads back (7)',
  },

  scale: {
    label: (length, where) => (where ? `Scale: ${length} ${where}` : `Scale: ${length}`),
    centre: 'at the centre',
    target: 'at the target',
    units: (count) => (count === 1 ? 'unit' : 'units'),
  },

  grid: { label: (step) => `Grid with lines every ${step}`, east: 'E', north: 'N' },

  minimap: {
    label: 'Overview map from the top, with what the picture shows',
    tip: 'Click or drag to go there',
    failed: 'The map could not be loaded.',
  },

  legend: {
    label: 'Legend',
    more: (count) => `and ${count} more`,
    clouds: 'Clouds',
    level: (level) => `Level ${level}`,
    levels: 'Coarse to fine, then again',
    inverse: (unit) => `1/${unit}`,
  },
};
