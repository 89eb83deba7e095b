// What the right side of a comparison shows instead of what the left one does, and how an address says it. Pure.
//
// { cloud, method, color, shading, classes, at }: members that are undefined are as on the left; `at`: where the divider stands, 0 to 100.

const name = /^[A-Za-z0-9._-]{1,64}$/;
const colour = /^(#?[0-9a-f]{6}|[A-Za-z0-9._-]{1,64})(\*intensity)?$/i;
const word = 'compare';
export const usualSides = { at: 50 };

const readers = {
  cloud: (text) => (name.test(text) ? text : undefined),
  method: (text) => (name.test(text) ? text : undefined),
  color: (text) => (colour.test(text) ? (/^[0-9a-f]{6}/i.test(text) ? `#${text}` : text) : undefined),
  shading: (text) => (name.test(text) ? text : undefined),
  classes: (text) => (text === 'all' ? 'all' : /^\d{1,3}$/.test(text) && Number(text) < 256 ? Number(text) : undefined),
  at: (text) => (/^\d{1,3}(\.\d)?$/.test(text) && Number(text) <= 100 ? Number(text) : undefined),
};

/** What the right side begins with, so that there is something to be seen: a colour that the left one does not have; undefined where there is none. */
export function otherColour(view, cloud, colors) {
  const has = (color) => color === 'elevation' || (cloud.attributes ?? []).some(({ name }) => name === color);
  const [left] = (view.color === 'auto' ? cloud.look?.color ?? ['rgb', 'intensity', 'elevation'].find(has) : view.color ?? '').split('*');
  return ['elevation', 'intensity', 'classification', 'rgb'].find((color) => color !== left && has(color) && colors.includes(color));
}

/** '&compare=method:point;at:40'. */
export function printSides(sides) {
  const parts = Object.keys(readers).filter((key) => sides[key] !== undefined)
    .map((key) => `${key}:${key === 'at' ? Math.round(sides.at * 10) / 10 : String(sides[key]).replace('#', '')}`);
  return `&${word}=${parts.map(encodeURIComponent).join(';').replaceAll('%3A', ':').replaceAll('%2C', ',')}`;
}

/** What an address's hash says of it; undefined where it says nothing. What is not understood is left out. */
export function parseSides(hash) {
  const part = String(hash ?? '').replace(/^#/, '').split('&').find((one) => one.startsWith(`${word}=`));
  if (!part || part.length > 512) return undefined;
  const sides = { ...usualSides };
  for (const pair of part.slice(word.length + 1).split(/;|%3B/i)) {
    let text = '';
    try {
      text = decodeURIComponent(pair);
    } catch {
      continue;
    }
    const [key, value = ''] = text.split(/:(.*)/s);
    if (!Object.hasOwn(readers, key)) continue;
    const read = readers[key](value);
    if (read !== undefined) sides[key] = read;
  }
  return sides;
}

/** The style of the right side, where that of the left is `style`; `auto`: the shading that is left to the server. */
export function rightStyle(style, { method, color, shading, classes }) {
  return {
    ...style,
    ...(method === undefined || method === style.method ? {} : { method, param: {}, detail: null }),
    ...(color === undefined || color === style.color ? {} : { color, range: null }),
    ...(shading === undefined ? {} : { shading: shading === 'auto' ? null : shading }),
    ...(classes === undefined ? {} : { classes: classes === 'all' ? null : [classes] }),
  };
}
