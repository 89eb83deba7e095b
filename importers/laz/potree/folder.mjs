// A Potree octree on disk: its JSON file and the files beside it. Nothing outside its folder is ever opened.
import { closeSync, constants, existsSync, openSync, readdirSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';

import { ScanFailure, failureCode, grouped, malformed, unsupported } from '../failure.mjs';
import { FileBytes, openFile } from '../file_bytes.mjs';

export const entryFiles = ['metadata.json', 'cloud.js'];
const longestJson = 64 << 20;

export class PotreeFolder {
  #root;

  /// `path`: the folder, or its cloud.js or metadata.json.
  constructor(path) {
    const isEntry = entryFiles.includes(basename(path));
    const folder = openSync(isEntry ? dirname(path) : path, constants.O_RDONLY | constants.O_DIRECTORY);
    // Stays open: everything is looked up in this very folder.
    this.#root = `/proc/self/fd/${folder}`;
    this.entry = isEntry ? basename(path) : entryFiles.find((name) => existsSync(join(this.#root, name)));
    if (!this.entry) throw unsupported('it is a folder without cloud.js or metadata.json, so it is no Potree octree');
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

  /// A path for FileBytes, of a file or a folder that is there and in the folder, whatever links there are.
  resolve(name) {
    const path = join(this.#root, name);
    if (path !== this.#root && !path.startsWith(`${this.#root}/`)) throw malformed(`its file ${name} is outside its folder`);
    try {
      closeSync(openFile(path));
    } catch (error) {
      if (error.code === 'ENOENT' || error.code === 'ENOTDIR') throw malformed(`its file ${name} is missing`);
      throw error;
    }
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
    const file = this.open(name);
    try {
      if (file.size > longest)
        throw new ScanFailure(failureCode.tooLarge, `its file ${name} has ${grouped(file.size)} bytes; ${grouped(longest)} at most are read`);
      return file.readAll(0, file.size, `its file ${name}`);
    } finally {
      file.close();
    }
  }

  sizeOf(name) {
    const file = this.open(name);
    file.close();
    return file.size;
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
