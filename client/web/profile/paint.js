// Paints a profile onto a canvas: its picture, axes of stations and heights, and what is measured in it. The same for the panel and for the picture
// that is saved.

import { edgesOf, ticks, toPixel } from './plot_view.js';

/** What axes take of the canvas, in CSS pixels. */
export const margin = { left: 64, right: 12, top: 10, bottom: 30 };

export const plotSize = ({ width, height }) =>
  ({ width: Math.max(40, width - margin.left - margin.right), height: Math.max(30, height - margin.top - margin.bottom) });

const digits = (value, decimals) => value.toLocaleString('en', { minimumFractionDigits: decimals, maximumFractionDigits: decimals }).replace('-', '−');
const font = (px) => `${px}px system-ui, sans-serif`;

/** Where the plot's corner is whole device pixels, what lies on pixels stays sharp. */
const sharp = (value, ratio) => (Math.floor(value * ratio) + 0.5) / ratio;

function paintAxes(context, { view, size, words, colours, ratio }) {
  const plot = plotSize(size);
  const { left, right, bottom, top } = edgesOf(view, plot);
  const along = ticks(left, right, plot.width / 90);
  const up = ticks(bottom, top, plot.height / 34);
  context.font = font(12);
  context.lineWidth = 1 / ratio;
  context.strokeStyle = colours.ink;
  context.globalAlpha = 0.14;
  context.beginPath();
  const columns = along.values.map((station) => ({ station, x: margin.left + toPixel(view, plot, { station, height: bottom }).x }));
  const rows = up.values.map((height) => ({ height, y: margin.top + toPixel(view, plot, { station: left, height }).y }));
  for (const { x } of columns) {
    context.moveTo(sharp(x, ratio), margin.top);
    context.lineTo(sharp(x, ratio), margin.top + plot.height + 4);
  }
  for (const { y } of rows) {
    context.moveTo(margin.left - 4, sharp(y, ratio));
    context.lineTo(margin.left + plot.width, sharp(y, ratio));
  }
  context.stroke();
  context.globalAlpha = 1;
  context.fillStyle = colours.ink;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const { station, x } of columns) context.fillText(digits(station, along.decimals), x, margin.top + plot.height + 6);
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const { height, y } of rows) if (y > margin.top + 4) context.fillText(digits(height, up.decimals), margin.left - 7, y);
  context.globalAlpha = 0.8;
  context.font = font(11);
  context.textBaseline = 'bottom';
  context.fillText(words.station, margin.left + plot.width, size.height - 1);
  context.save();
  context.translate(11, margin.top + plot.height / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(words.height, 0, 0);
  context.restore();
  context.globalAlpha = 1;
}

function paintMeasure(context, { view, size, colours, measure }) {
  if (!measure || measure.places.length === 0) return;
  const plot = plotSize(size);
  const at = measure.places.map((place) => {
    const { x, y } = toPixel(view, plot, place);
    return { x: margin.left + x, y: margin.top + y };
  });
  context.lineJoin = context.lineCap = 'round';
  if (at.length === 2) {
    const [a, b] = at;
    context.setLineDash([3, 5]);
    context.strokeStyle = colours.mark;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(a.x, a.y);
    context.lineTo(b.x, a.y);
    context.lineTo(b.x, b.y);
    context.stroke();
    context.setLineDash([]);
    for (const [width, style] of [[4.5, colours.halo], [2, colours.mark]]) {
      context.lineWidth = width;
      context.strokeStyle = style;
      context.beginPath();
      context.moveTo(a.x, a.y);
      context.lineTo(b.x, b.y);
      context.stroke();
    }
  }
  for (const { x, y } of at) {
    context.beginPath();
    context.arc(x, y, 4.5, 0, 2 * Math.PI);
    context.fillStyle = colours.mark;
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = colours.halo;
    context.stroke();
  }
  if (!measure.text) return;
  context.font = font(13);
  const { x, y } = at.length === 2 ? { x: (at[0].x + at[1].x) / 2, y: (at[0].y + at[1].y) / 2 } : at[0];
  const wide = context.measureText(measure.text).width + 14;
  const box = { x: Math.min(size.width - wide - 2, Math.max(margin.left, x - wide / 2)), y: Math.max(margin.top, y - 32) };
  context.fillStyle = 'rgb(15 18 22 / 88%)';
  context.beginPath();
  context.roundRect(box.x, box.y, wide, 21, 6);
  context.fill();
  context.fillStyle = '#fff';
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  context.fillText(measure.text, box.x + 7, box.y + 11);
}

/**
 * `what`: { view, size and ratio (of the canvas, CSS pixels, and device pixels for one), picture: { image, left, right, bottom, top } or
 * nothing, words: { station, height } (at the axes), colours: { ground, ink, mark, halo }, measure: { places, text }, cross: a place }.
 */
export function paint(context, what) {
  const { view, size, ratio, picture, colours, cross } = what;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = colours.ground;
  context.fillRect(0, 0, size.width, size.height);
  if (!view) return;
  const plot = plotSize(size);
  paintAxes(context, what);
  context.save();
  context.beginPath();
  context.rect(margin.left, margin.top, plot.width, plot.height);
  context.clip();
  if (picture) {
    const from = toPixel(view, plot, { station: picture.left, height: picture.top });
    const to = toPixel(view, plot, { station: picture.right, height: picture.bottom });
    // Where one of its pixels is one of the canvas, it is to stay that.
    const [wide, high] = [(to.x - from.x) * ratio, (to.y - from.y) * ratio];
    const isSame = Math.abs(wide / picture.image.width - 1) < 2e-3 && Math.abs(high / picture.image.height - 1) < 2e-3;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.imageSmoothingEnabled = !isSame && wide < picture.image.width;
    const [x, y] = [Math.round((margin.left + from.x) * ratio), Math.round((margin.top + from.y) * ratio)];
    context.drawImage(picture.image, x, y, isSame ? picture.image.width : wide, isSame ? picture.image.height : high);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }
  paintMeasure(context, what);
  if (cross) {
    const { x, y } = toPixel(view, plot, cross);
    context.strokeStyle = colours.ink;
    context.lineWidth = 1 / ratio;
    context.beginPath();
    for (const [ax, ay, bx, by] of [[x, 0, x, plot.height], [0, y, plot.width, y]]) {
      context.moveTo(margin.left + sharp(ax, ratio), margin.top + sharp(ay, ratio));
      context.lineTo(margin.left + sharp(bx, ratio), margin.top + sharp(by, ratio));
    }
    context.stroke();
  }
  context.restore();
}
