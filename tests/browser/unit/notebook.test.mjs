// How often the notebook's view tells Python (client/python/scancast/widget.js), in a time of its own.

import assert from 'node:assert/strict';
import { describe, it, mock } from 'node:test';

import { unhurried } from '../../../client/python/scancast/widget.js';

describe('what is told without hurry', () => {
  it('comes at once, then no more often than said, and its last word is never lost', () => {
    mock.timers.enable();
    try {
      const told = [];
      let value = 0;
      const tell = unhurried(() => told.push(value), 150);
      for (value = 1; value <= 10; ++value) {
        tell();
        mock.timers.tick(40);
      }
      value = 99;
      assert.deepEqual(told, [1, 4, 8]);
      tell();
      tell();
      for (let i = 0; i < 5; ++i) mock.timers.tick(200);
      assert.deepEqual(told, [1, 4, 8, 99]);
      tell();
      assert.deepEqual(told, [1, 4, 8, 99, 99], 'after a pause it is told at once');
      value = 100;
      tell();
      tell.stop();
      mock.timers.tick(1000);
      assert.equal(told.length, 5);
    } finally {
      mock.timers.reset();
    }
  });
});
