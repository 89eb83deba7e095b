// The variable length records of LAS and LAZ: coordinate reference system and LASzip's own. Like
// renderer/cloud/import/las/las_crs.cpp: a damaged record is passed over, whatever number the header gives.
import { number64 } from './las_header.mjs';

const vlrHeaderBytes = 54;
const evlrHeaderBytes = 60;
const longestVlrs = 4 << 20;
const mostEvlrs = 1000;
const longestWkt = 65536;
const wktRecord = 2112;
const geoKeyRecord = 34735;
const projectedKey = 3072;
const geographicKey = 2048;
const userDefined = 32767;
const laszipRecord = 22204;
const extraBytesRecord = 4;
const longestRecord = 65536;

const userIdOf = (bytes, at) => bytes.toString('latin1', at, at + 16);
const projectionId = 'LASF_Projection\0';
const specId = 'LASF_Spec\0\0\0\0\0\0\0';
const laszipId = 'laszip encoded\0\0';

/// Value of a GeoTIFF key that stands in the directory itself: four numbers of head (the fourth is the number of
/// keys), then four numbers a key: id, where, count, value.
function geoKey(directory, wanted) {
  if (directory.length < 8) return undefined;
  const keys = Math.min(directory.readUInt16LE(6), Math.floor(directory.length / 8) - 1);
  for (let i = 1; i <= keys; ++i) {
    const value = directory.readUInt16LE(8 * i + 6);
    const here = directory.readUInt16LE(8 * i + 2) === 0;
    if (directory.readUInt16LE(8 * i) === wanted && here && value !== 0 && value !== userDefined) return value;
  }
  return undefined;
}

function takeRecord(found, userId, recordId, content) {
  if (userId === projectionId && recordId === wktRecord && !found.wkt && content.length <= longestWkt)
    found.wkt = content.toString('latin1');
  if (userId === projectionId && recordId === geoKeyRecord && found.epsg === undefined)
    found.epsg = geoKey(content, projectedKey) ?? geoKey(content, geographicKey);
  if (userId === specId && recordId === extraBytesRecord && !found.extraBytes && content.length <= longestRecord)
    found.extraBytes = Buffer.from(content);
  if (userId === laszipId && recordId === laszipRecord && !found.laszip) found.laszip = Buffer.from(content);
}

/// Records between header and points, then those behind the points: { wkt, epsg, laszip, extraBytes }, each if it is there.
export function readRecords(file, las) {
  const found = { wkt: '' };
  let bytes = file.readSome(las.headerBytes, Math.min(las.pointOffset - las.headerBytes, longestVlrs));
  for (let i = 0; i < las.vlrs && bytes.length >= vlrHeaderBytes; ++i) {
    const length = bytes.readUInt16LE(20);
    const end = vlrHeaderBytes + length;
    if (end > bytes.length) break; // runs into the points: its length is wrong, and so is all that follows
    takeRecord(found, userIdOf(bytes, 2), bytes.readUInt16LE(18), bytes.subarray(vlrHeaderBytes, end));
    bytes = bytes.subarray(end);
  }
  let at = las.evlrOffset;
  for (let i = 0; i < Math.min(las.evlrs, mostEvlrs) && at > las.pointOffset && at < file.size; ++i) {
    const head = file.readSome(at, evlrHeaderBytes);
    if (head.length < evlrHeaderBytes) break;
    const length = number64(head, 20);
    at += evlrHeaderBytes;
    if (length > file.size - at) break;
    const userId = userIdOf(head, 2);
    if ((userId === projectionId || userId === specId) && length <= longestRecord)
      takeRecord(found, userId, head.readUInt16LE(18), file.readSome(at, length));
    at += length;
  }
  return found;
}
