import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { Exchange } from '../../../client/web/view/exchange.js';

/** An exchange whose pictures are what show() was told of them, and a connection that takes down what is sent. */
function begun() {
  const pictures = [];
  const picture = { mostPixels: 1e7, showItself() {}, show: async (frame, from) => pictures.push({ seq: frame.seq, eye: from?.camera }) > 0 };
  const exchange = new Exchange({ dataset: {} }, picture);
  const connection = {
    congested: false,
    nextSeq: 1,
    sent: [],
    sendView(changes) { this.sent.push(changes); return this.nextSeq++; },
  };
  const look = (eye) => exchange.change({ camera: { eye } });
  const send = (eye) => { look(eye); return exchange.send(connection, eye, false); };
  const frame = (seq) => exchange.show({ seq, frameId: seq }, {});
  exchange.begin({ cloud: 'town', camera: { eye: 'a' }, width: 64, height: 48 }, 1);
  assert.equal(send('a'), 1);
  /** Says the hello of another server, as session.js does. */
  const hello = (eye) => { const seq = connection.nextSeq++; return { cloud: 'town', seq, view: exchange.say(seq, eye) }; };
  return { exchange, connection, pictures, look, send, frame, hello };
}

describe('an exchange whose server is another one from now on', () => {
  it('shows nothing older than what is on the canvas, and says all that is wanted', async () => {
    const { exchange, connection, pictures, send, frame, hello, look } = begun();
    const said = hello('a');
    await frame(send('b'));
    await frame(send('c'));
    look('d');
    exchange.moved(said, connection.nextSeq);
    assert.equal(await frame(said.seq), undefined, 'what the hello said is old by now');
    assert.deepEqual(pictures.map(({ eye }) => eye), ['b', 'c']);
    assert.equal(exchange.send(connection, 'd', false), 5);
    assert.deepEqual(connection.sent.at(-1), { cloud: 'town', camera: { eye: 'd' }, width: 64, height: 48 });
    assert.ok(await frame(5));
  });

  it('says it also where the hand has come back to what the hello said before it is asked', async () => {
    const { exchange, connection, send, frame, hello, look } = begun();
    const said = hello('a');
    await frame(send('b'));
    exchange.moved(said, connection.nextSeq);
    look('a');
    assert.equal(exchange.send(connection, 'a', false), 4);
    assert.ok(await frame(4));
  });

  it('knows from where the picture of the hello is, also where later ones have been shown', async () => {
    const { exchange, connection, pictures, send, frame, hello } = begun();
    const said = hello('a');
    await frame(send('b'));
    send('a'); // and what the other server draws of it comes too late
    exchange.moved(said, connection.nextSeq);
    assert.equal(exchange.send(connection, 'a', false), undefined, 'it knows');
    assert.ok(await frame(said.seq));
    assert.deepEqual(pictures.map(({ eye }) => eye), ['b', 'a']);
  });
});
