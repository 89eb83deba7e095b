// What the page says of saving a picture.

export const picture = {
  title: 'Save a picture',
  size: 'Size',
  presets: {
    screen: 'As on screen', twice: 'Twice as on screen', four: 'Four times as on screen', hd: 'Full HD', uhd: '4K', square: 'Square', a4: 'A4, 300 dpi', a3: 'A3, 300 dpi',
    a1: 'A1, 300 dpi', most: 'As large as possible', free: 'Another size',
  },
  preset: (name, width, height) => `${name} (${width} × ${height})`,
  width: 'Width',
  height: 'Height',
  pixels: (least, most) => `Whole numbers of pixels from ${least} to ${most}.`,
  format: 'Format',
  formats: { png: 'PNG: exact', jpg: 'JPEG: smaller' },
  furniture: 'On the picture',
  parts: { scale: 'Scale bar', legend: 'Legend', north: 'North', credit: 'Title and attribution' },
  noNorth: 'The scan does not say where north is.',
  plain: 'A picture of that size comes without scale bar, legend, north and title: no browser can draw on it.',
  save: 'Save',
  cancel: 'Cancel',
  close: 'Close',
  drawing: 'The server is drawing…',
  coming: (share) => `${share} %`,
  comingBytes: (text) => `${text} MB`,
  composing: 'Putting scale bar, legend and title on it…',
  cancelled: 'Cancelled. Nothing has been saved.',
  notComposed: 'Saved without scale bar, legend, north and title: this browser has no memory to draw on a picture of that size.',
};
