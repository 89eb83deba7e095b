// What a point of a Potree octree is made of: a layout of bytes, from the names in its JSON file.
import { malformed, unsupported } from '../failure.mjs';
import { countOf } from './folder.mjs';

const mostAttributes = 200;
const longestAttribute = 4096;

// Names and bytes of Potree 1.
const bytesOfName = {
  POSITION_CARTESIAN: 12,
  COLOR_PACKED: 4,
  RGBA_PACKED: 4,
  RGBA: 4,
  RGB_PACKED: 3,
  NORMAL_SPHEREMAPPED: 2,
  NORMAL_OCT16: 2,
  NORMAL: 12,
  NORMAL_FLOATS: 12,
  INTENSITY: 2,
  CLASSIFICATION: 1,
  RETURN_NUMBER: 1,
  NUMBER_OF_RETURNS: 1,
  SOURCE_ID: 2,
  INDICES: 4,
  SPACING: 4,
  GPS_TIME: 8,
  FILLER_1B: 1,
};

// What becomes a column, by name (small letters, blanks for underscores) and bytes: [role, how it is stored].
const roles = {
  // Potree itself reads them as unsigned; what writes them does not, and points a step outside of their cube are real.
  'position cartesian/12': ['position', 'int32'],
  'position/12': ['position', 'int32'],
  'color packed/4': ['color', 'uint8'],
  'color packed/3': ['color', 'uint8'],
  'rgba packed/4': ['color', 'uint8'],
  'rgb packed/3': ['color', 'uint8'],
  'rgba/4': ['color', 'uint8'],
  'rgb/3': ['color', 'uint8'],
  'rgb/6': ['color', 'uint16'],
  'rgba/8': ['color', 'uint16'],
  'intensity/2': ['intensity', 'uint16'],
  'classification/1': ['classification', 'uint8'],
  'normal spheremapped/2': ['normal', 'sphere'],
  'normal oct16/2': ['normal', 'octahedron'],
  'normal/12': ['normal', 'float'],
  'normal floats/12': ['normal', 'float'],
  'normalx/4': ['normalX', 'float'],
  'normaly/4': ['normalY', 'float'],
  'normalz/4': ['normalZ', 'float'],
};

function nameAndBytes(attribute, i) {
  if (typeof attribute === 'string') {
    const bytes = bytesOfName[attribute];
    if (bytes === undefined) throw unsupported(`the Potree attribute "${attribute.slice(0, 40)}" is not known here`);
    return [attribute, bytes];
  }
  const name = attribute?.name;
  if (typeof name !== 'string') throw malformed(`attribute ${i} has no name`);
  return [name, countOf(attribute.size, `the size of the attribute "${name.slice(0, 40)}"`, longestAttribute)];
}

/// { bytes, attributes: [{ role, stored, at, bytes }] }; role is undefined for what is passed over.
export function layOutAttributes(list) {
  if (!Array.isArray(list) || list.length === 0 || list.length > mostAttributes)
    throw malformed('its list of point attributes is missing, empty or endless');
  const layout = { bytes: 0, attributes: [] };
  const taken = new Set();
  list.forEach((entry, i) => {
    const [name, bytes] = nameAndBytes(entry, i);
    let [role, stored] = roles[`${name.toLowerCase().replaceAll('_', ' ')}/${bytes}`] ?? [];
    if (taken.has(role)) role = undefined;
    taken.add(role);
    layout.attributes.push({ role, stored, at: layout.bytes, bytes });
    layout.bytes += bytes;
  });
  if (!taken.has('position')) throw malformed('its points have no position of three 32-bit numbers');
  return layout;
}

export const attributeOf = (layout, role) => layout.attributes.find((attribute) => attribute.role === role);

/// The columns of the point stream that a layout gives.
export const columnsOf = (layout) => ({
  color: !!attributeOf(layout, 'color'),
  intensity: !!attributeOf(layout, 'intensity'),
  classification: !!attributeOf(layout, 'classification'),
  normal:
    !!attributeOf(layout, 'normal') || ['normalX', 'normalY', 'normalZ'].every((role) => attributeOf(layout, role)),
});
