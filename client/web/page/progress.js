// How far a cloud is that the server reads, in words: what is being done, how much of it, and how long it may take.

const leastSeconds = 3;
const leastShare = 0.02;

const stageNames = {
  reading: 'Reading the scan', sorting: 'Sorting the points', building: 'Building the levels of detail', finishing: 'Finishing',
};

export const percent = (share) => `${Math.floor(Math.min(1, Math.max(0, share)) * 100)} %`;

/** 8 → "a few seconds", 130 → "about 2 minutes". */
export function timeText(seconds) {
  if (seconds < 10) return 'a few seconds';
  if (seconds < 55) return `about ${Math.round(seconds / 10) * 10 || 10} seconds`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 2) return 'about a minute';
  if (minutes < 60) return `about ${minutes} minutes`;
  return minutes < 90 ? 'about an hour' : `about ${Math.round(minutes / 60)} hours`;
}

/** How long what is left of a stage takes, by how it has gone since it was first heard of. Pure but for the clock given. */
export class Pace {
  #of;
  #start;

  /** Seconds, or undefined where nobody can know yet. `of` names what the share is of. */
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

/** { step, percent, left } of an entry of the list, each a text, empty where it is not known. The server's progress is that of the stage. */
export function progressWords({ id, stage, progress }, pace, now = performance.now()) {
  const step = stage ? (stageNames[stage] ?? stage.charAt(0).toUpperCase() + stage.slice(1)) : 'Waiting for its turn';
  const known = typeof progress === 'number';
  const seconds = pace.left(`${id} ${stage}`, known ? progress : NaN, now);
  return { step, percent: known ? percent(progress) : '', left: seconds === undefined ? '' : `${timeText(seconds)} left of this step` };
}
