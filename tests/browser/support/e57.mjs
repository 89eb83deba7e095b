// Writes small E57 files (ASTM E2807) with scans and photos, so that the way from a scanner's file to the page can be walked by
// a test. It shares nothing with our reader.

const pageLength = 1024, contentOfPage = 1020;
const perPacket = 3000; // of 15 bytes each: a packet has 64 KiB at most

const table = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >>> 1) ^ 0x82f63b78 : crc >>> 1;
  return crc >>> 0;
});
/** CRC-32C. */
function checksum(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = (crc >>> 8) ^ table[(crc ^ byte) & 255];
  return (crc ^ 0xffffffff) >>> 0;
}

const numbers = (bytes, write, values) => {
  const buffer = Buffer.alloc(values.length * bytes);
  values.forEach((value, i) => buffer[write](value, i * bytes));
  return buffer;
};
const u16 = (...values) => numbers(2, 'writeUInt16LE', values);
const u64 = (...values) => numbers(8, 'writeBigUInt64LE', values.map(BigInt));
const padded = (bytes) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
/** Where a byte of the content is in the file, checksums included. */
const physical = (logical) => Math.floor(logical / contentOfPage) * pageLength + (logical % contentOfPage);

function packet(points) {
  const streams = [0, 1, 2].map((axis) => numbers(4, 'writeFloatLE', points.map((point) => point[axis])))
    .concat([3, 4, 5].map((channel) => Buffer.from(points.map((point) => point[channel]))));
  const bytes = padded(Buffer.concat([Buffer.from([1, 0]), u16(0, streams.length, ...streams.map((stream) => stream.length)), ...streams]));
  bytes.writeUInt16LE(bytes.length - 1, 2);
  return bytes;
}

const float = (name, value) => `<${name} type="Float">${value}</${name}>`;
const integer = (name, value) => `<${name} type="Integer">${value}</${name}>`;
const text = (name, value) => `<${name} type="String"><![CDATA[${value}]]></${name}>`;
const poseXml = ({ rotation: [w, x, y, z], translation }) =>
  `<pose type="Structure"><rotation type="Structure">${float('w', w)}${float('x', x)}${float('y', y)}${float('z', z)}</rotation>`
  + `<translation type="Structure">${['x', 'y', 'z'].map((axis, i) => float(axis, translation[i])).join('')}</translation></pose>`;

/**
 * `scans`: { name, points: [[x, y, z, r, g, b], …], pose: { rotation: [w, x, y, z], translation } }, with points as that scanner
 * sees them. `photos`: { name, scan (a number), jpeg, width, height, pose, focal and pixel (metres) of a flat one, or angle
 * (radians a pixel) of a panorama }.
 */
export function e57Bytes(scans, photos) {
  const parts = [Buffer.alloc(48)];
  let end = 48;
  const append = (bytes) => {
    const at = end;
    parts.push(bytes);
    end += bytes.length;
    return at;
  };
  const scansXml = scans.map(({ name, points, pose }, i) => {
    const packets = [];
    for (let first = 0; first < points.length; first += perPacket) packets.push(packet(points.slice(first, first + perPacket)));
    const length = 32 + packets.reduce((sum, one) => sum + one.length, 0);
    const at = append(Buffer.concat([u64(1, length, physical(end + 32), 0), ...packets]));
    const fields = ['X', 'Y', 'Z'].map((axis) => `<cartesian${axis} type="Float" precision="single"/>`)
      .concat(['Red', 'Green', 'Blue'].map((channel) => `<color${channel} type="Integer" minimum="0" maximum="255"/>`));
    const limits = ['Red', 'Green', 'Blue'].map((channel) => integer(`color${channel}Minimum`, 0) + integer(`color${channel}Maximum`, 255));
    return `<vectorChild type="Structure">${text('guid', `scan ${i}`)}${text('name', name)}${poseXml(pose)}`
      + `<colorLimits type="Structure">${limits.join('')}</colorLimits>`
      + `<points type="CompressedVector" fileOffset="${physical(at)}" recordCount="${points.length}">`
      + `<prototype type="Structure">${fields.join('')}</prototype><codecs type="Vector" allowHeterogeneousChildren="1"></codecs></points></vectorChild>`;
  });
  const photosXml = photos.map(({ name, scan, jpeg, width, height, pose, focal, pixel, angle }, i) => {
    const at = append(padded(Buffer.concat([u64(0, 16 + jpeg.length), jpeg])));
    const kind = angle ? 'spherical' : 'pinhole';
    const size = integer('imageWidth', width) + integer('imageHeight', height) + float('pixelWidth', angle ?? pixel) + float('pixelHeight', angle ?? pixel);
    const camera = angle ? '' : float('focalLength', focal) + float('principalPointX', width / 2) + float('principalPointY', height / 2);
    return `<vectorChild type="Structure">${text('guid', `photo ${i}`)}${text('name', name)}${text('associatedData3DGuid', `scan ${scan}`)}${poseXml(pose)}`
      + `<${kind}Representation type="Structure"><jpegImage type="Blob" fileOffset="${physical(at)}" length="${jpeg.length}"/>${size}${camera}</${kind}Representation></vectorChild>`;
  });
  const xml = Buffer.from('<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure" xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0">'
    + text('formatName', 'ASTM E57 3D Imaging Data File') + text('guid', 'file') + integer('versionMajor', 1) + integer('versionMinor', 0)
    + `<data3D type="Vector" allowHeterogeneousChildren="1">${scansXml.join('')}</data3D>`
    + `<images2D type="Vector" allowHeterogeneousChildren="1">${photosXml.join('')}</images2D></e57Root>`);
  const xmlAt = append(xml);
  const pages = Math.ceil(end / contentOfPage);
  const content = Buffer.concat(parts, pages * contentOfPage);
  Buffer.concat([Buffer.from('ASTM-E57'), numbers(4, 'writeUInt32LE', [1, 0]), u64(pages * pageLength, physical(xmlAt), xml.length, pageLength)]).copy(content);
  return Buffer.concat(Array.from({ length: pages }, (_, i) => {
    const page = content.subarray(i * contentOfPage, (i + 1) * contentOfPage);
    const sealed = Buffer.alloc(4);
    sealed.writeUInt32BE(checksum(page));
    return Buffer.concat([page, sealed]);
  }));
}
