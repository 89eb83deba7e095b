// How far a cloud is that the server reads, in words: what is being done, how much of it, and how long it may take.

import { strings } from './strings.js';

const words = strings.progress;
const leastSeconds = 3;
const leastShare = 0.02;

/** What the server does with a scan, in order, and about how much of all that each takes. */
const stages = [
  { name: 'reading', weight: 0.15 }, { name: 'sorting', weight: 0.1 }, { name: 'building', weight: 0.7 }, { name: 'finishing', weight: 0.05 },
];

export const percent = (share) => `${Math.floor(Math.min(1, Math.max(0, share)) * 100)} %`;

/** 8 → "a few seconds", 130 → "about 2 minutes". */
export function timeText(seconds) {
  if (seconds < 10) return words.fewSeconds;
  if (seconds < 55) return words.seconds(Math.round(seconds / 10) * 10);
  const minutes = Math.round(seconds / 60);
  if (minutes < 2) return words.minute;
  if (minutes < 60) return words.minutes(minutes);
  return minutes < 90 ? words.hour : words.hours(Math.round(minutes / 60));
}

/**
 * How much of everything is done, 0 to 1: the server says it of the stage that it is at. Of a stage that nobody knows here it
 * is what the server says; undefined where it says nothing. Pure.
 */
export function shareOf({ stage, progress }) {
  const at = stages.findIndex(({ name }) => name === stage);
  const known = typeof progress === 'number' ? progress : undefined;
  if (at < 0) return known;
  const before = stages.slice(0, at).reduce((sum, { weight }) => sum + weight, 0);
  return before + stages[at].weight * (known ?? 0);
}

/** How long what is left takes, by how it has gone since it was first heard of. Pure but for the clock given. */
export class Pace {
  #of;
  #start;

  /** Seconds, or undefined where nobody can know yet. `of` names what the share is of, which begins anew with another. */
  left(of, share, now) {
    if (!(share >= 0)) return undefined;
    if (of !== this.#of || share < this.#start.share) {
      this.#of = of;
      this.#start = { share, now };
    }
    const done = share - this.#start.share;
    const seconds = (now - this.#start.now) / 1000;
    return done >= leastShare && seconds >= leastSeconds ? (seconds * (1 - share)) / done : undefined;
  }
}

/** { step, share, percent, left } of an entry of the list: texts, empty where they are not known, and the share, 0 to 1. */
export function progressWords(entry, pace, now = performance.now()) {
  const { id, stage } = entry;
  const step = stage ? (words.stages[stage] ?? stage.charAt(0).toUpperCase() + stage.slice(1)) : words.waiting;
  const share = shareOf(entry);
  const seconds = pace.left(id, share, now);
  return { step, share, percent: share === undefined ? '' : percent(share), left: seconds === undefined ? '' : words.left(timeText(seconds)) };
}
