// What an importer says when it cannot go on: a code of the point stream and one plain English sentence.

/// Codes of a FAIL record, as renderer/cloud/import/stream/POINT_STREAM.md lists them.
export const failureCode = Object.freeze({
  malformed: 1,
  truncated: 2,
  empty: 3,
  unsupported: 4,
  system: 5,
  tooLarge: 6,
});

export class ScanFailure extends Error {
  constructor(code, sentence) {
    super(sentence);
    this.code = code;
  }
}

export const malformed = (sentence) => new ScanFailure(failureCode.malformed, sentence);
export const truncated = (sentence) => new ScanFailure(failureCode.truncated, sentence);
export const empty = (sentence) => new ScanFailure(failureCode.empty, sentence);
export const unsupported = (sentence) => new ScanFailure(failureCode.unsupported, sentence);
export const tooLarge = (sentence) => new ScanFailure(failureCode.tooLarge, sentence);

/// Any thrown thing as a failure: what the system or the engine says, in words.
export function asFailure(error) {
  if (error instanceof ScanFailure) return error;
  if (error?.syscall) return new ScanFailure(failureCode.system, `the system refused: ${error.message}`);
  const outOfMemory = error instanceof RangeError && /allocation|memory|length/i.test(error.message);
  if (outOfMemory) return tooLarge('there is not enough memory to read it');
  return malformed(`reading it failed: ${error?.message ?? error}`);
}

/// 1234567 → "1,234,567".
export const grouped = (number) => String(number).replace(/\B(?=(\d{3})+$)/g, ',');
