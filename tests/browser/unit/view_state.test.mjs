import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { difference, ViewState } from '../../../client/web/view/view_state.js';

const start = { cloud: 'town', camera: { eye: [1, 1, 1] }, method: 'cone', param: { gain: 1 }, color: 'rgb' };

describe('difference', () => {
  it('says only what changed, and a parameter that went', () => {
    assert.deepEqual(difference(start, { ...start, color: 'elevation' }), { color: 'elevation' });
    assert.deepEqual(difference(start, { ...start, param: {} }), { param: { gain: null } });
    assert.deepEqual(difference(start, { ...start }), {});
  });

  it('takes the parameters along with a method, because the server drops the old ones', () => {
    assert.deepEqual(difference(start, { ...start, method: 'point' }), { method: 'point', param: { gain: 1 } });
  });
});

describe('ViewState', () => {
  const begun = () => {
    const state = new ViewState();
    state.begin(start);
    assert.deepEqual(state.take(1), start);
    return state;
  };

  it('says everything once, then only news', () => {
    const state = begun();
    assert.equal(state.take(2), undefined);
    state.change({ color: 'depth' });
    state.change({ color: 'lod' });
    assert.ok(state.hasNews());
    assert.deepEqual(state.take(2), { color: 'lod' });
    assert.ok(!state.hasNews());
  });

  it('a refusal takes back what was refused and nothing else, and then says everything', () => {
    const state = begun();
    state.shown(1);
    state.change({ method: 'nonsense', param: {} });
    state.take(2);
    state.change({ camera: { eye: [2, 2, 2] } }); // the hand did not wait
    state.take(3);
    assert.ok(state.refused(2, start));
    assert.deepEqual(state.wanted, { ...start, camera: { eye: [2, 2, 2] } });
    assert.deepEqual(state.take(4), state.wanted);
  });

  it('a frame of a view accepts those before it too', () => {
    const state = begun();
    state.change({ color: 'depth' });
    state.take(2);
    state.shown(2);
    state.change({ method: 'nonsense' });
    state.take(3);
    assert.ok(state.refused(3, start));
    assert.equal(state.wanted.color, 'depth');
    assert.equal(state.wanted.method, 'cone');
  });

  it('before anything was accepted, a refusal leads to what surely works', () => {
    const state = new ViewState();
    state.begin({ ...start, method: 'nonsense' });
    state.take(1);
    assert.ok(state.refused(1, start));
    assert.deepEqual(state.wanted, start);
  });

  it('does not ask again and again for what is refused as such', () => {
    const state = begun();
    assert.ok(!state.refused(1, start));
    assert.equal(state.take(2), undefined);
  });

  it('knows nothing of refusals of messages that it did not send', () => {
    assert.ok(!begun().refused(99, start));
  });

  it('goes on from what another server was told, whatever this one was told since', () => {
    const state = begun();
    state.change({ color: 'depth' });
    const told = { ...state.wanted };
    state.change({ color: 'lod' });
    assert.deepEqual(state.take(2), { color: 'lod' });
    state.said(3, told);
    assert.deepEqual(state.take(4), { color: 'lod' });
    state.said(5, { ...state.wanted });
    assert.equal(state.take(6), undefined);
    assert.ok(state.refused(5, start), 'and can be refused what it was told first');
    assert.equal(state.wanted.color, 'rgb');
  });
});
