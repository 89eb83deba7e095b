// The folder of a Potree octree: what was opened counts, not what has its name by now, and nothing outside of it is read.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';

import { FileBytes } from '../../../../importers/laz/file_bytes.mjs';
import { PotreeFolder } from '../../../../importers/laz/potree/folder.mjs';

function withOctree(work) {
  const place = mkdtempSync(join(tmpdir(), 'scancast-test-'));
  const octree = join(place, 'octree');
  try {
    mkdirSync(join(octree, 'data'), { recursive: true });
    writeFileSync(join(octree, 'cloud.js'), '{"version": "1.7"}');
    writeFileSync(join(octree, 'data', 'r.bin'), 'inside');
    writeFileSync(join(place, 'secret'), 'outside');
    work(octree, place);
  } finally {
    rmSync(place, { recursive: true });
  }
}

const textOf = (folder, name) => folder.readFile(name, 100).toString();

test('a folder, or its description, leads to the same files', () => {
  withOctree((octree) => {
    for (const path of [octree, join(octree, 'cloud.js')]) {
      const folder = new PotreeFolder(path);
      assert.equal(folder.entry, 'cloud.js');
      assert.equal(folder.readJson().version, '1.7');
      assert.equal(textOf(folder, 'data/r.bin'), 'inside');
      assert.equal(folder.sizeOf('data/r.bin'), 6);
    }
  });
});

test('nothing outside is read, whatever leads there', () => {
  withOctree((octree) => {
    symlinkSync('../secret', join(octree, 'link'));
    symlinkSync('..', join(octree, 'up'));
    const folder = new PotreeFolder(octree);
    for (const name of ['link', '../secret', 'up/secret', 'data/../../secret'])
      assert.throws(() => textOf(folder, name), /is outside its folder/, name);
    assert.throws(() => textOf(folder, 'none'), /its file none is missing/);
    symlinkSync('data/r.bin', join(octree, 'within'));
    assert.equal(textOf(folder, 'within'), 'inside');
  });
});

test('what is put in its place after a look is looked at again', () => {
  withOctree((octree) => {
    const folder = new PotreeFolder(octree);
    const path = folder.resolve('data/r.bin'); // as it goes to a worker
    rmSync(join(octree, 'data', 'r.bin'));
    symlinkSync('../../secret', join(octree, 'data', 'r.bin'));
    assert.throws(() => new FileBytes(path), /is outside its folder/);
    rmSync(join(octree, 'data', 'r.bin'));
    execFileSync('mkfifo', [join(octree, 'data', 'r.bin')]);
    assert.throws(() => new FileBytes(path), /it is not a file/);
  });
});

test('another folder of the same name is another folder', () => {
  withOctree((octree, place) => {
    const folder = new PotreeFolder(octree);
    renameSync(octree, join(place, 'moved'));
    mkdirSync(join(octree, 'data'), { recursive: true });
    writeFileSync(join(octree, 'data', 'r.bin'), 'another');
    assert.equal(textOf(folder, 'data/r.bin'), 'inside');
  });
});
