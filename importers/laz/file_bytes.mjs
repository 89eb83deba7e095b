// A file as bytes at offsets: regular files only, every read bounded by the caller.
import { closeSync, constants, fstatSync, openSync, readSync } from 'node:fs';

import { ScanFailure, failureCode, grouped, truncated } from './failure.mjs';

export class FileBytes {
  #fd;

  constructor(path) {
    this.#fd = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK);
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
