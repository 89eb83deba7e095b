// A margin around the picture, asked for while the camera moves: what comes into view before the next frame is there has been
// drawn already. The page shows the middle, in which every pixel is what it would be without a margin. Pure.

/** Of width and height, on each side. */
const marginShare = 0.04;
const widest = 150; // degrees: a field of view that is not widened any more

/**
 * A view with a margin around it, and how much wider and higher that makes its picture; undefined where it can have none.
 * @param {object} view as the protocol has it
 * @param {number} mostPixels that a picture may have
 * @returns {{ view: object, stretch: { x: number, y: number } } | undefined}
 */
export function withMargin(view, mostPixels = Infinity) {
  const { camera } = view;
  const [width, height] = [view.width, view.height].map((side) => side + 2 * Math.round(side * marginShare));
  if (!camera || !(width * height <= mostPixels) || camera.fov > widest) return undefined;
  const stretch = { x: width / view.width, y: height / view.height };
  const larger = camera.type === 'orthographic'
    ? { viewHeight: camera.viewHeight * stretch.y }
    : { fov: (360 / Math.PI) * Math.atan(Math.tan((camera.fov * Math.PI) / 360) * stretch.y) };
  return { view: { ...view, width, height, camera: { ...camera, ...larger } }, stretch };
}
