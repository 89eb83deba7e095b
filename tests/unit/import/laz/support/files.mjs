// Real scans, and a folder for one test.
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/// The real scan's path; undefined, after saying so, where it is missing.
export function testData(t, name) {
  const path = join(process.env.SCANCAST_TEST_DATA ?? '', name);
  if (existsSync(path)) return path;
  t.skip(`the real scan ${path} is missing`);
  return undefined;
}

export function temporaryFolder(t) {
  const folder = mkdtempSync(join(tmpdir(), 'scancast-test-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/// A writer of the point stream that only counts.
export class CountingWriter {
  scan = null;
  notes = [];
  points = 0;
  dropped = 0;
  ended = false;
  buffers = [];

  constructor({ keep = false } = {}) {
    this.keep = keep;
  }
  header(scan) {
    this.scan = scan;
  }
  note(sentence) {
    this.notes.push(sentence);
  }
  chunk(buffer, points, dropped) {
    this.points += points;
    this.dropped += dropped;
    if (this.keep) this.buffers.push(buffer);
  }
}
