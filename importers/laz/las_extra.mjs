// What a LAS point record holds besides the sample: GPS time, returns, angles, flags, infrared, extra bytes. Pure
// functions on bytes, with the names and rules of renderer/cloud/import/las/las_columns.cpp: LAS and LAZ must not differ.
import { recordLayout } from './las_header.mjs';
import { printableText } from './point_stream.mjs';

// One descriptor of the Extra Bytes record, ASPRS LAS 1.4 R15, table 24.
const descriptorBytes = 192;
const textBytes = 32;
const hasScale = 8;
const hasOffset = 16;
const mostExtraColumns = 256;
const highestType = 30;

// Types 1 to 10; 11 to 20 are pairs of them and 21 to 30 triples, both deprecated since.
const types = ['uint8', 'int8', 'uint16', 'int16', 'uint32', 'int32', 'uint64', 'int64', 'float32', 'float64'];
const bytesOf = (type) => Number(/\d+/.exec(type)[0]) / 8;

const field = (name, at, type, description = '') => ({
  name, type, scale: 1, offset: 0, description, at, bytes: bytesOf(type), shift: 0, bits: 8,
});
const bitsOf = (name, at, shift, bits, description = '') => ({ ...field(name, at, 'uint8', description), shift, bits });

const flagMeaning = '1 synthetic, 2 key point, 4 withheld';

/// Point formats 0-5, table 7.
const oldFields = () => [
  bitsOf('return_number', 14, 0, 3),
  bitsOf('number_of_returns', 14, 3, 3),
  bitsOf('scan_direction_flag', 14, 6, 1),
  bitsOf('edge_of_flight_line', 14, 7, 1),
  bitsOf('class_flags', 15, 5, 3, flagMeaning),
  field('scan_angle', 16, 'int8', 'degrees'),
  field('user_data', 17, 'uint8'),
  field('point_source_id', 18, 'uint16'),
];

/// Point formats 6-10, table 14.
const newFields = () => [
  bitsOf('return_number', 14, 0, 4),
  bitsOf('number_of_returns', 14, 4, 4),
  bitsOf('class_flags', 15, 0, 4, `${flagMeaning}, 8 overlap`),
  bitsOf('scanner_channel', 15, 4, 2),
  bitsOf('scan_direction_flag', 15, 6, 1),
  bitsOf('edge_of_flight_line', 15, 7, 1),
  { ...field('scan_angle', 18, 'int16', 'degrees'), scale: 0.006 },
  field('user_data', 17, 'uint8'),
  field('point_source_id', 20, 'uint16'),
];

/// Extra bytes being given their columns, front to back.
class ExtraColumns {
  #columns;
  #at;
  #end;
  #added = 0;
  #unnamed = 0;

  constructor(columns, at, end) {
    this.#columns = columns;
    this.#at = at;
    this.#end = end;
  }

  /// False when the bytes that it speaks of are not there, or it makes no sense.
  describe(descriptor) {
    const [kind, options] = [descriptor[2], descriptor[3]];
    const textAt = (at) => printableText(descriptor.toString('latin1', at, at + textBytes), textBytes);
    const name = textAt(4);
    const numbered = (i) => name && `${name}_${i}`;
    if (kind === 0) {
      // Undocumented: `options` is the number of bytes.
      if (options > this.#end - this.#at) return false;
      for (let i = 0; i < options; ++i) this.#add(field('', this.#at, 'uint8'), numbered(i));
      return true;
    }
    if (kind > highestType) return false;
    const type = types[(kind - 1) % 10];
    const values = 1 + Math.floor((kind - 1) / 10);
    if (values * bytesOf(type) > this.#end - this.#at) return false;
    for (let i = 0; i < values; ++i) {
      const column = field('', this.#at, type, textAt(160));
      const scale = descriptor.readDoubleLE(112 + 8 * i);
      const offset = descriptor.readDoubleLE(136 + 8 * i);
      if (options & hasScale && Number.isFinite(scale) && scale !== 0) column.scale = scale;
      if (options & hasOffset && Number.isFinite(offset)) column.offset = offset;
      this.#add(column, values === 1 ? name : numbered(i));
    }
    return true;
  }

  /// All that are left, one by one.
  rest() {
    while (this.#at < this.#end && this.#added < mostExtraColumns) this.#add(field('', this.#at, 'uint8'), '');
  }

  #add(column, name) {
    if (this.#added < mostExtraColumns) {
      const wanted = name || `extra_${this.#unnamed++}`;
      const taken = (candidate) => this.#columns.some((other) => other.name === candidate);
      column.name = wanted;
      for (let copy = 2; taken(column.name); ++copy) column.name = `${wanted}_${copy}`;
      this.#columns.push(column);
      ++this.#added;
    }
    this.#at += column.bytes;
  }
}

/// { bytes of a row, columns: [{ name, type, scale, offset, description, at, bytes, shift, bits }] }: the point format's
/// columns, then those of the extra bytes, which `description`, the content of their record, may describe.
export function furtherColumns(las, description = Buffer.alloc(0)) {
  const format = las.pointFormat;
  const columns = format >= 6 ? newFields() : oldFields();
  const time = las.adjustedTime
    ? 'adjusted standard GPS time: seconds since 1980-01-06, less 1e9'
    : 'seconds of the GPS week';
  if (format === 1 || format === 3) columns.push(field('gps_time', 20, 'float64', time));
  if (format >= 6) columns.push(field('gps_time', 22, 'float64', time));
  if (format === 8) columns.push(field('nir', 36, 'uint16'));
  const extra = new ExtraColumns(columns, recordLayout(format).bytes, las.recordBytes);
  for (let at = 0; at + descriptorBytes <= description.length; at += descriptorBytes)
    if (!extra.describe(description.subarray(at, at + descriptorBytes))) break;
  extra.rest();
  return { bytes: columns.reduce((sum, column) => sum + column.bytes, 0), columns };
}

/// Writes a row for each of `count` records at `at` of `heap` to `to` of `out`.
export function fillRows(heap, at, count, las, { bytes, columns }, out, to) {
  for (const column of columns) {
    const mask = (1 << column.bits) - 1;
    const { shift } = column;
    let from = at + column.at;
    let row = to;
    for (let i = 0; i < count; ++i, from += las.recordBytes, row += bytes) {
      if (column.bytes === 1) out[row] = (heap[from] >> shift) & mask;
      else for (let k = 0; k < column.bytes; ++k) out[row + k] = heap[from + k];
    }
    to += column.bytes;
  }
}
