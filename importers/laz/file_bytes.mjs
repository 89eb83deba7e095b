// A file as bytes at offsets: regular files only, every read bounded by the caller. Files are judged when they are open, not by
// their names: what has a name now may be something else when it is opened.
import { closeSync, constants, fstatSync, openSync, readSync, readlinkSync } from 'node:fs';
import { relative, sep } from 'node:path';

import { ScanFailure, failureCode, grouped, malformed, truncated } from './failure.mjs';

const readOnly = constants.O_RDONLY | constants.O_NONBLOCK;
// What is in a folder that this process has open.
const inOpenFolder = /^(\/proc\/self\/fd\/\d+)\/(.+)$/;

/// A descriptor. What is asked of an open folder (/proc/self/fd/3/…) has to be in there, whatever links lead to it.
export function openFile(path) {
  const fd = openSync(path, readOnly);
  const [, folder, name] = inOpenFolder.exec(path) ?? [];
  if (!folder) return fd;
  const inside = relative(readlinkSync(folder), readlinkSync(`/proc/self/fd/${fd}`));
  if (inside !== '..' && !inside.startsWith(`..${sep}`) && !inside.startsWith(sep)) return fd;
  closeSync(fd);
  throw malformed(`its file ${name} is outside its folder`);
}

export class FileBytes {
  #fd;

  constructor(path) {
    this.#fd = openFile(path);
    const info = fstatSync(this.#fd);
    if (!info.isFile()) {
      closeSync(this.#fd);
      throw new ScanFailure(failureCode.unsupported, 'it is not a file');
    }
    this.size = info.size;
  }

  /// As many of `length` bytes at `at` as there are.
  readSome(at, length) {
    const bytes = Buffer.allocUnsafe(Math.max(0, Math.min(length, this.size - at)));
    return bytes.subarray(0, this.readInto(bytes, at));
  }

  /// All of them, or a failure that says what for.
  readAll(at, length, what) {
    const bytes = this.readSome(at, length);
    if (bytes.length === length) return bytes;
    throw truncated(`it ends at byte ${grouped(at + bytes.length)}, within ${what}`);
  }

  readInto(bytes, at) {
    let got = 0;
    while (got < bytes.length) {
      const now = readSync(this.#fd, bytes, got, bytes.length - got, at + got);
      if (now === 0) break;
      got += now;
    }
    return got;
  }

  close() {
    closeSync(this.#fd);
  }
}
