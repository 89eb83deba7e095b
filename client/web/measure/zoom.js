// To what has been measured or noted: so near that it fills most of the picture.

import { fit, radiusOf } from '../view/camera.js';
import { boundsOf } from './values.js';

export function zoomTo(viewer, points) {
  const { camera, cssSize, bounds, cloud } = viewer;
  const { min, max } = boundsOf(points);
  const air = Math.max(0.2 * Math.max(...max.map((value, axis) => value - min[axis])), 20 * (cloud.spacing ?? 0), 1e-3 * radiusOf(bounds));
  const around = { min: min.map((value) => value - air), max: max.map((value) => value + air) };
  if (camera) viewer.goTo(fit(camera, around, cssSize, viewer.freeSize(cssSize)));
}
