// The page's types, which its comments tell, hold: TypeScript's checker finds nothing to complain of.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { it } from 'node:test';
import { fileURLToPath } from 'node:url';

const checker = fileURLToPath(new URL('../node_modules/typescript/bin/tsc', import.meta.url));
const page = fileURLToPath(new URL('../../../client/web', import.meta.url));

it('the page is what its types say', () => {
  assert.ok(existsSync(checker), 'typescript is missing. Run: (cd tests/browser && npm ci --ignore-scripts)');
  const { status, stdout } = spawnSync(process.execPath, [checker, '-p', page], { encoding: 'utf8' });
  assert.equal(status, 0, stdout);
});
