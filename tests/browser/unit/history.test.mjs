// Address, undo and redo without a browser: what is written, when, and how often.

import assert from 'node:assert/strict';
import { beforeEach, describe, it, mock } from 'node:test';

import { Address, Steps, Undo } from '../../../client/web/page/history.js';

// The clock of performance.now() goes with the timers.
let now = 0;
mock.method(performance, 'now', () => now);
mock.timers.enable({ apis: ['setTimeout'] });
const pass = (ms) => {
  for (let i = 0; i < ms; i += 10) {
    now += 10;
    mock.timers.tick(10);
  }
};

describe('Address', () => {
  let text, written, address;
  beforeEach(() => {
    written = [];
    address = new Address(() => text, (what, pushes) => written.push([what, pushes]));
    pass(5000);
  });
  const show = (what) => {
    text = what;
    address.changed();
  };

  it('says what is shown once it is still, and once', () => {
    for (const step of ['a', 'b', 'c']) {
      show(step);
      pass(100);
    }
    assert.deepEqual(written, []);
    pass(300);
    assert.deepEqual(written, [['c', false]]);
    pass(5000);
    assert.equal(written.length, 1);
  });

  it('keeps the place that was left, and makes the next one an entry of its own', () => {
    show('here');
    pass(10);
    address.jump();
    assert.deepEqual(written, [['here', false]], 'at once, before it is gone');
    show('on the way');
    pass(100);
    address.jump(); // on from there before it has been reached
    show('there');
    pass(900);
    assert.deepEqual(written, [['here', false], ['there', true]]);
    show('there, moved a little');
    pass(900);
    assert.deepEqual(written.at(-1), ['there, moved a little', false]);
  });

  it('does not write over what has just been gone back to', () => {
    show('a');
    address.arrived();
    pass(1000);
    assert.deepEqual(written, []);
  });

  it('stays below what browsers allow: 100 times in 30 seconds', () => {
    const end = now + 30_000;
    while (now < end) {
      show(String(now));
      pass(310);
    }
    assert.ok(written.length > 20 && written.length <= 62, String(written.length));
  });

  it('says nothing while there is nothing to say', () => {
    show(undefined);
    pass(1000);
    assert.deepEqual(written, []);
  });
});

describe('Steps', () => {
  it('lead back and forth, and a new one ends what was undone', () => {
    const steps = new Steps();
    for (const key of ['a', 'b', 'b', 'c']) steps.add({ key });
    assert.deepEqual([steps.undo().key, steps.undo().key, steps.undo()], ['b', 'a', undefined]);
    assert.equal(steps.redo().key, 'b');
    steps.add({ key: 'd' });
    assert.ok(!steps.canRedo);
    assert.deepEqual([steps.undo().key, steps.undo().key], ['b', 'a']);
  });

  it('are bounded', () => {
    const steps = new Steps();
    for (let key = 0; key < 500; ++key) steps.add({ key });
    let count = 0;
    while (steps.undo()) ++count;
    assert.equal(count, 100);
  });
});

describe('Undo', () => {
  let view, can, undo;
  const look = (key, cloud = 'town') => {
    view = { key, cloud };
  };
  beforeEach(() => {
    can = undefined;
    view = undefined;
    // What is shown again tells of itself, as any view does.
    undo = new Undo(() => view, (step) => { look(step.key, step.cloud); undo.changed(); }, (now) => { can = now; });
    look('first');
    undo.changed(true);
    pass(700);
  });

  it('takes for a step what has been still for a moment', () => {
    for (const key of ['a', 'b', 'c']) {
      look(key);
      undo.changed();
      pass(100);
    }
    pass(700);
    assert.deepEqual(can, { canUndo: true, canRedo: false });
    undo.undo();
    assert.equal(view.key, 'first');
    assert.deepEqual(can, { canUndo: false, canRedo: true });
    pass(700);
    undo.redo();
    assert.equal(view.key, 'c');
  });

  it('several in a hurry, and of what is still moving', () => {
    for (const key of ['a', 'b']) {
      look(key);
      undo.changed();
      pass(700);
    }
    look('moving');
    undo.changed();
    undo.undo();
    undo.undo();
    assert.equal(view.key, 'a');
    undo.redo();
    undo.redo();
    assert.equal(view.key, 'moving');
    assert.ok(!can.canRedo);
  });

  it('knows what a cloud is first seen as, however soon a hand is there', () => {
    look('of another cloud', 'statue');
    undo.changed(true);
    look('moved at once', 'statue');
    undo.changed();
    pass(700);
    undo.undo();
    assert.equal(view.key, 'of another cloud');
  });

  it('what the server chose is no step, but another cloud is', () => {
    look('complete now');
    undo.changed(true);
    pass(700);
    assert.ok(!can.canUndo);
    look('elsewhere', 'statue');
    undo.changed(true);
    pass(700);
    assert.ok(can.canUndo);
    undo.undo();
    assert.deepEqual(view, { key: 'complete now', cloud: 'town' });
  });
});
