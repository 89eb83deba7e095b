// The small pure pieces around the page.

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';

import { base64url } from '../../../client/web/connection/access.js';
import { wheelPixels } from '../../../client/web/view/camera_input.js';
import { closeWords } from '../../../client/web/connection/connection.js';
import { guestOf, renewIn } from '../../../client/web/connection/guest.js';
import { FrameClock } from '../../../client/web/page/hud.js';
import { labelOf, sliderScale } from '../../../client/web/page/parameter_fields.js';
import { altOf, factsOf, fittedScale, mostZoom, photosText, sizeText } from '../../../client/web/page/photos.js';
import { outside, rangeRefusal } from '../../../client/web/page/number_field.js';
import { Pace, progressWords, shareOf, timeText } from '../../../client/web/page/progress.js';
import { pictureSize } from '../../../client/web/view/picture.js';
import { backOff } from '../../../client/web/connection/session.js';
import { amount } from '../../../client/web/page/strings.js';
import { labelOfStation } from '../../../client/web/page/stations.js';

describe('base64url', () => {
  it('is what Node makes of it, whatever the length', () => {
    for (const text of ['', 'a', 'ab', 'abc', '+/=?~', 'ÿ€']) assert.equal(base64url(text), Buffer.from(text).toString('base64url'));
  });
});

describe("a guest's link", () => {
  it('is told from the rest of the hash', () => {
    assert.deepEqual(guestOf('#guest=abc'), { token: 'abc', rest: '' });
    assert.deepEqual(guestOf('#cloud=a&guest=scg1.x_-.y&eye=1,2,3'), { token: 'scg1.x_-.y', rest: '#cloud=a&eye=1,2,3' });
    for (const hash of ['', '#', '#guest=', '#cloud=guest', '#myguest=a', '#cloud=a&eye=1']) assert.equal(guestOf(hash), undefined);
  });
  it('is renewed well before its pass ends', () => {
    assert.equal(renewIn(3600), 2_880_000);
    assert.equal(renewIn(1), 5000);
    assert.ok(renewIn(1e12) < 2 ** 31, 'what a timer can wait');
  });
});

describe('pictureSize', () => {
  it('respects the device pixel ratio up to 2, and never asks for more pixels than allowed', () => {
    assert.deepEqual(pictureSize(390, 844, 3), { width: 780, height: 1688, ratio: 2 });
    assert.deepEqual(pictureSize(1000, 500, 1), { width: 1000, height: 500, ratio: 1 });
    for (const [width, height, ratio, limit] of [[5000, 3000, 2, 0], [1920, 1080, 2, 1e6], [30, 9000, 1, 1e5]]) {
      const size = pictureSize(width, height, ratio, limit);
      assert.ok(size.width * size.height <= (limit || 3840 * 2160));
      assert.ok(Math.abs(size.width / size.height / (width / height) - 1) < 0.05, 'another shape');
    }
    for (const ratio of [0, NaN, undefined, -1]) assert.ok(pictureSize(300, 300, ratio).width >= 16);
  });
});

describe('sliderScale', () => {
  it('round trip, monotone, from end to end', () => {
    for (const parameter of [{ min: 0, max: 1 }, { min: 0, max: 256 }, { min: 0.01, max: 100 }, { min: -5, max: 5 }]) {
      const { toValue, toSlider } = sliderScale(parameter);
      assert.equal(toValue(0), parameter.min);
      assert.ok(Math.abs(toValue(1) - parameter.max) < 1e-9);
      let last = -Infinity;
      for (let t = 0; t <= 1; t += 0.05) {
        assert.ok(toValue(t) > last);
        last = toValue(t);
        assert.ok(Math.abs(toSlider(last) - t) < 1e-9);
      }
      assert.ok(toSlider(parameter.max * 10) <= 1 && toSlider(parameter.min - 10) >= 0);
    }
    assert.equal(sliderScale({ min: 2, max: 2 }).toValue(0.7), 2);
  });

  it('a factor of 1 stands in the middle of 0.01 … 100', () => {
    assert.ok(Math.abs(sliderScale({ min: 0.01, max: 100 }).toValue(0.5) - 1) < 1e-9);
  });
});

describe('words for people', () => {
  it('name parameters', () => {
    assert.equal(labelOf({ name: 'sizePx', unit: 'px' }), 'Point size');
    assert.equal(labelOf({ name: 'minPx', unit: 'px' }), 'Minimum size');
    assert.equal(labelOf({ name: 'edgeSharpness' }), 'Edge sharpness');
    assert.equal(labelOf({ name: 'edgeWidthPx', unit: 'px' }), 'Edge width');
  });

  it('say amounts', () => {
    assert.deepEqual([999, 12345, 1_234_567, 123_456_789, 2.5e9, NaN].map(amount),
      ['999', '12,345', '1.2 million', '123 million', '2.5 billion', '–']);
  });

  it('say why a connection ended', () => {
    assert.match(closeWords(1013, ''), /taken/);
    assert.equal(closeWords(1008, 'No.'), 'No.');
    assert.match(closeWords(1006, ''), /not responding/);
  });
});

describe('FrameClock', () => {
  it('measures from the request to its first picture and counts frames of the last second', () => {
    const clock = new FrameClock();
    clock.asked(1, 100);
    clock.asked(2, 110);
    clock.drawn(2, 150);
    assert.equal(clock.latency, 40);
    clock.drawn(2, 400); // a refinement
    assert.equal(clock.latency, 40);
    assert.equal(clock.framesPerSecond(500), 2);
    assert.equal(clock.framesPerSecond(1200), 1);
  });

  it('does not grow while nothing comes back', () => {
    const clock = new FrameClock();
    for (let seq = 1; seq <= 5000; ++seq) clock.asked(seq, seq);
    clock.drawn(1, 6000); // long forgotten
    assert.ok(Number.isNaN(clock.latency));
  });
});

describe('progress', () => {
  it('is of everything that is to be done, not of the step', () => {
    const said = [['reading', 0], ['reading', 1], ['sorting', 0.5], ['building', 0], ['building', 1], ['finishing', 1]]
      .map(([stage, progress]) => shareOf({ stage, progress }));
    assert.ok(said.every((share, i) => i === 0 || share >= said[i - 1]), 'it never goes back');
    assert.equal(said[0], 0);
    assert.ok(Math.abs(said.at(-1) - 1) < 1e-9);
    assert.equal(shareOf({ stage: 'thinking', progress: 0.3 }), 0.3);
    assert.equal(shareOf({}), undefined);
  });

  it('tells how long it takes once that can be known, by how it went', () => {
    const pace = new Pace();
    const at = (progress, seconds, id = 'a') => progressWords({ id, stage: 'thinking', progress }, pace, seconds * 1000);
    assert.deepEqual(at(0.2, 0), { step: 'Thinking', share: 0.2, percent: '20 %', left: '' });
    assert.equal(at(0.21, 10).left, '', 'too little to judge by');
    assert.equal(at(0.4, 20).left, 'about a minute left'); // 0.01 a second, 0.6 to go
    assert.equal(at(0.4, 21, 'b').left, '', 'of another cloud nothing is known');
    assert.deepEqual(progressWords({ id: 'c' }, pace, 0), { step: 'Waiting for its turn', share: undefined, percent: '', left: '' });
    assert.deepEqual([3, 34, 90, 60 * 44, 60 * 70, 3600 * 5].map(timeText),
      ['a few seconds', 'about 30 seconds', 'about 2 minutes', 'about 44 minutes', 'about an hour', 'about 5 hours']);
  });
});

describe('a field for a number', () => {
  it('says why it refuses', () => {
    const parameter = { min: 0.01, max: 100, unit: 'px' };
    assert.deepEqual([0, 101, NaN, 5].map((value) => outside(value, parameter)), ['Must be at least 0.01 px.', 'Must be at most 100 px.', 'Enter a number.', '']);
    assert.equal(rangeRefusal([2, 2]), 'The minimum must be less than the maximum.');
    for (const ends of [[1, 2], [NaN, 2], [1, NaN]]) assert.equal(rangeRefusal(ends), '');
  });
});

describe('backOff', () => {
  it('grows, is bounded, and spreads', () => {
    assert.equal(backOff(0, 1), 500);
    assert.equal(backOff(2, 1), 2000);
    assert.equal(backOff(50, 1), 10_000);
    assert.equal(backOff(50, 0), 7500);
  });
});

describe('wheelPixels', () => {
  it('takes lines and pages for pixels, and no jump beyond reason', () => {
    assert.equal(wheelPixels({ deltaMode: 0, deltaY: 100 }, 800), 100);
    assert.equal(wheelPixels({ deltaMode: 1, deltaY: 3 }, 800), 99);
    assert.equal(wheelPixels({ deltaMode: 2, deltaY: -1 }, 800), -400);
    assert.equal(wheelPixels({ deltaMode: 0, deltaY: 1e6 }, 800), 400);
  });
});

describe('what is said of photos', () => {
  it('is as much as is known', () => {
    const photo = { name: 'A', projection: 'spherical', width: 8192, height: 4096, bytes: 5_300_000, station: { index: 0, name: 'Tower' } };
    assert.equal(factsOf(photo), 'Panorama, 8,192 × 4,096, 5.3 MB, taken at Tower');
    assert.equal(altOf(photo), 'The panorama A, taken at Tower');
    assert.equal(factsOf({ name: 'B', projection: 'visual', bytes: 17 }), 'Picture, 17 bytes');
    assert.equal(altOf({ name: 'B', projection: 'fisheye', bytes: 17 }), 'The photo B');
    assert.equal(sizeText(999), '999 bytes');
    assert.equal(sizeText(1234), '1.2 kB');
    assert.equal(sizeText(134_217_728), '134 MB');
    assert.equal(photosText(1), '1 photo');
    assert.equal(photosText(1200), '1,200 photos');
    assert.equal(labelOfStation({ name: 'Tower', points: 0 }), 'Tower');
    assert.equal(labelOfStation({ name: 'Tower', points: 0, photos: [3] }), 'Tower (1 photo)');
    assert.equal(labelOfStation({ name: 'Tower', points: 2e6, photos: [0, 3] }), 'Tower (2.0 million points, 2 photos)');
  });
  it('fits into the room, and small ones grow a little', () => {
    assert.equal(fittedScale({ width: 2000, height: 1000 }, { width: 500, height: 500 }), 0.25);
    assert.equal(fittedScale({ width: 1000, height: 2000 }, { width: 500, height: 500 }), 0.25);
    assert.equal(fittedScale({ width: 10, height: 10 }, { width: 500, height: 500 }), 2);
    assert.equal(fittedScale({ width: 5, height: 5 }, { width: 0, height: 0 }), 1, 'a viewer that is not to be seen yet');
    assert.equal(mostZoom(0.25) * 0.25, 2, 'until its own pixels are two wide');
    assert.equal(mostZoom(2), 4);
  });
});
