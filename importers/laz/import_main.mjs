// What both importer programs have in common: arguments, and the end of the stream, whatever happens.
import { writeSync } from 'node:fs';
import { isatty } from 'node:tty';

import { asFailure } from './failure.mjs';
import { PointStreamWriter } from './point_stream.mjs';

/// Runs `importScan(path, writer, { keepAttributes })` for the arguments of the program. Exit status 0 also for a scan that is refused:
/// the stream says why.
export async function main(usage, importScan) {
  const words = process.argv.slice(2);
  const keepAttributes = words[0] === '--keep-attributes';
  const [path, ...more] = keepAttributes ? words.slice(1) : words;
  if (!path || path.startsWith('-') || more.length > 0 || isatty(1)) {
    writeSync(2, usage);
    process.exit(2);
  }
  const writer = new PointStreamWriter(1);
  try {
    await importScan(path, writer, { keepAttributes });
    writer.done();
  } catch (error) {
    if (error.code === 'EPIPE') process.exit(1); // nobody reads any more
    writer.fail(asFailure(error));
  }
  process.exit(0);
}
