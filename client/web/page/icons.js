// The page's drawings, as strokes in a square of 24: one weight, round ends, no fill.

const drawings = {
  orbit: 'M12 8.2a3.8 3.8 0 1 0 0 7.6 3.8 3.8 0 0 0 0-7.6M3.6 15.2C2.4 13.3 2.9 11.4 5 10m15.4-1.2c1.2 1.9.7 3.8-1.4 5.2M5 10c2.6-1.9 8-2.8 12-1.9m2 5.9c-2.6 1.9-8 2.8-12 1.9m0 0 2.3-1.6M7 15.9l1.6 2.2M17 8.1l-2.3 1.6M17 8.1l-1.6-2.2',
  look: 'M2.5 12S6 5.8 12 5.8 21.5 12 21.5 12 18 18.2 12 18.2 2.5 12 2.5 12M12 9.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6',
  fly: 'M3.5 11.5 20.5 4l-6 16.5-3.4-6.6z M11.1 13.9 20.5 4',
  measure: 'M3.5 16.5 16.5 3.5l4 4-13 13zM7 13l2 2m1-5 3 3m1-6 2 2',
  clip: 'M4 8V4h4m8 0h4v4m0 8v4h-4M8 20H4v-4M4 12h16',
  filter: 'M3.5 5h17l-6.7 8v6l-3.6-2v-4z',
  profile: 'M3.5 19.5h17M3.5 16c3-1 4-8 7-8s3 5 5 5 3-4 5-4',
  annotate: 'M5 5h14v10h-7l-4 4v-4H5z',
  together: 'M4 9.5 12 5l8 4.5-8 4.5zM4 14.5l8 4.5 8-4.5',
  compare: 'M4 5.5h6.5v13H4zM13.5 5.5H20v13h-6.5M12 3v18',
  views: 'M3.5 5h7.5v6H3.5zM13 5h7.5v6H13zM3.5 13h7.5v6H3.5zM13 13h7.5v6H13z',
  picture: 'M4 8h3.2L9 5.5h6L16.8 8H20v11H4zM12 10a3.4 3.4 0 1 0 0 6.8 3.4 3.4 0 0 0 0-6.8',
  export: 'M12 3.5v11m0 0-4-4m4 4 4-4M4.5 15v4.5h15V15',
  present: 'M3 4.5h18M4.5 4.5v10.5h15V4.5M12 15v2.5m0 0L8.5 21m3.5-3.5 3.5 3.5M10.5 7.5v4.5l3.8-2.2z',
  kindPoint: 'M12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6M12 3v3m0 12v3M3 12h3m12 0h3',
  kindDistance: 'M5 19 19 5M3 17l4 4M17 3l4 4',
  kindHorizontal: 'M4 18h16M4 15v6m16-6v6M4 15 20 5',
  kindHeight: 'M12 4v16M9 4h6M9 20h6M12 4l-2 3m2-3 2 3m-2 13-2-3m2 3 2-3',
  kindAngle: 'M20 19H4L15 5M13.5 19a9.5 9.5 0 0 0-3.7-7.4',
  kindArea: 'M4 9 13 4l7 6-3 9-11 1z',
  kindCircle: 'M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16M12 12h8',
  kindVolume: 'M4 8l8-4 8 4v8l-8 4-8-4zM4 8l8 4 8-4M12 12v8',
  kindCylinder: 'M5 6.5C5 5 8 4 12 4s7 1 7 2.5S16 9 12 9 5 8 5 6.5v11C5 19 8 20 12 20s7-1 7-2.5v-11',
  kindFitCircle: 'M12 5a7 7 0 1 0 0 14 7 7 0 0 0 0-14M12 5v.1M18.5 9.5v.1m-1.6 8.4v.1M7 18v.1M5.4 9.6v.1',
  kindPlane: 'M3 15l6-8h12l-6 8zM12 11l-3.5 8.5m0 0-.3-3m.3 3 2.4-1.8',
  kindSphere: 'M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16M4 12c0 1.8 3.6 3 8 3s8-1.2 8-3m-8-8c-2 0-3.4 3.6-3.4 8s1.4 8 3.4 8',
  shown: 'M2.5 12S6 5.8 12 5.8 21.5 12 21.5 12 18 18.2 12 18.2 2.5 12 2.5 12M12 9.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6',
  unshown: 'M2.5 12S6 5.8 12 5.8 21.5 12 21.5 12 18 18.2 12 18.2 2.5 12 2.5 12M4 4l16 16',
  undo: 'M8.5 5 4.5 9l4 4M4.5 9H14a5 5 0 0 1 0 10h-3',
  redo: 'M15.5 5l4 4-4 4M19.5 9H10a5 5 0 0 0 0 10h3',
};

const namespace = 'http://www.w3.org/2000/svg';

/** One of the drawings above, or a path of one's own, as an element that screen readers pass over. */
export function icon(name) {
  const svg = document.createElementNS(namespace, 'svg');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(namespace, 'path');
  path.setAttribute('d', drawings[name] ?? name);
  svg.append(path);
  return svg;
}
