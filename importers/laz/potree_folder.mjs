// A Potree octree on disk: its JSON file and the files beside it. Nothing outside its folder is ever opened.
import { existsSync, readFileSync, readdirSync, realpathSync, statSync } from 'node:fs';
import { basename, dirname, join, relative, sep } from 'node:path';

import { ScanFailure, failureCode, grouped, malformed, unsupported } from './failure.mjs';
import { FileBytes } from './file_bytes.mjs';

export const entryFiles = ['metadata.json', 'cloud.js'];
const longestJson = 64 << 20;

export class PotreeFolder {
  #root;

  /// `path`: the folder, or its cloud.js or metadata.json.
  constructor(path) {
    const isFolder = statSync(path).isDirectory();
    const entry = isFolder ? entryFiles.find((name) => existsSync(join(path, name))) : basename(path);
    if (!entryFiles.includes(entry))
      throw unsupported('it is a folder without cloud.js or metadata.json, so it is no Potree octree');
    this.#root = realpathSync(isFolder ? path : dirname(path));
    this.entry = entry;
  }

  readJson() {
    const file = this.open(this.entry);
    try {
      if (file.size > longestJson) throw malformed(`${this.entry} has ${grouped(file.size)} bytes, which is no description`);
      const value = JSON.parse(file.readAll(0, file.size, this.entry).toString('utf8'));
      if (value === null || typeof value !== 'object') throw new Error('it is not an object');
      return value;
    } catch (error) {
      if (error instanceof ScanFailure) throw error;
      throw malformed(`${this.entry} is not valid JSON: ${error.message}`);
    } finally {
      file.close();
    }
  }

  /// The absolute path of a file that is there and in the folder, whatever links there are.
  resolve(name) {
    let path;
    try {
      path = realpathSync(join(this.#root, name));
    } catch {
      throw malformed(`its file ${name} is missing`);
    }
    const inside = relative(this.#root, path);
    if (inside.startsWith(`..${sep}`) || inside === '..' || inside.startsWith(sep))
      throw malformed(`its file ${name} is outside its folder`);
    return path;
  }

  open(name) {
    return new FileBytes(this.resolve(name));
  }

  /// Whether there is something of that name; resolve() judges where it is.
  has(name) {
    return existsSync(join(this.#root, name));
  }

  /// What a folder holds, as Dirents: a link is neither folder nor file.
  list(name) {
    return readdirSync(this.resolve(name), { withFileTypes: true });
  }

  readFile(name, longest) {
    const path = this.resolve(name);
    const { size } = statSync(path);
    if (size > longest)
      throw new ScanFailure(failureCode.tooLarge, `its file ${name} has ${grouped(size)} bytes; ${grouped(longest)} at most are read`);
    return readFileSync(path);
  }

  sizeOf(name) {
    return statSync(this.resolve(name)).size;
  }
}

/// A finite number of a JSON file.
export function numberOf(value, what) {
  if (typeof value === 'number' && Number.isFinite(value)) return value;
  throw malformed(`${what} is ${JSON.stringify(value)?.slice(0, 40)}; it must be a number`);
}

export function vectorOf(value, what) {
  if (!Array.isArray(value) || value.length !== 3) throw malformed(`${what} must be three numbers`);
  return value.map((v, i) => numberOf(v, `${what}[${i}]`));
}

export function countOf(value, what, most = Number.MAX_SAFE_INTEGER) {
  if (Number.isInteger(value) && value >= 0 && value <= most) return value;
  throw malformed(`${what} is ${JSON.stringify(value)?.slice(0, 40)}; it must be a whole number from 0 to ${most}`);
}

/// Whatever `value` is, the coordinate reference system that it names, if any. PROJ's strings are none.
export function crsOf(value) {
  if (typeof value !== 'string') return {};
  const epsg = /^\s*EPSG:(\d{4,6})\s*$/i.exec(value);
  if (epsg) return { epsg: Number(epsg[1]) };
  return /^\s*[A-Z_]{4,}\s*\[/.test(value) ? { wkt: value } : {};
}

/// A hint, so a wrong one is none.
export function boundsOf(min, max) {
  const sound = [min, max].every((corner) => Array.isArray(corner) && corner.length === 3 && corner.every(Number.isFinite));
  return sound && min.every((low, i) => low <= max[i]) ? [min, max] : undefined;
}

export function checkGrid({ scale, offset }, file) {
  if (scale.some((s, i) => !(s > 0) || !Number.isFinite(Math.abs(offset[i]) + 2 ** 32 * s)))
    throw malformed(`${file}: the scale must be positive, and the points near enough to be numbers`);
}
