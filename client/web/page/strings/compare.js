// What the page says of comparing.

export const compare = {
  title: 'Compare',
  close: 'End comparing',
  how: 'Drag the divider, or move it by arrow keys. The left side is the view as it is; choose what the right side shows instead. Points are measured and noted on the left side.',
  begins: (color) => `The right side begins coloured by ${color.toLowerCase()}.`,
  divider: 'Divider between both sides',
  at: (share) => `${share} % left`,
  cloud: 'Point cloud',
  method: 'Method',
  color: 'Colour',
  shading: 'Lighting',
  classes: 'Classes',
  allClasses: 'All',
  same: 'As on the left',
  left: 'Left',
  right: 'Right',
  side: (name, parts) => (parts.length > 0 ? parts.join(' · ') : name),
  problem: 'The right side could not be shown',
};
