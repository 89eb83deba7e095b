// Jobs to worker threads, results back in the order of the jobs. Owned by the main thread.
//
// Bounded: a worker holds a few pieces that nobody has taken and then waits; jobs are handed out in order, so the one
// whose turn it is always runs, and nobody waits for ever. A worker that falls silent ends everything.
import { Worker } from 'node:worker_threads';
import * as os from 'node:os';

import { ScanFailure, failureCode, tooLarge } from './failure.mjs';

const mostWorkers = 16;
const secondsOfSilence = 120;
const heapMegabytes = 256;

const cores = () => os.availableParallelism?.() ?? os.cpus().length;

export class WorkerPool {
  #workers;
  #watch;
  #run = null;

  /// `url`: the worker's module. `jobs`: how many jobs there will be at most.
  constructor(url, jobs) {
    const count = Math.max(1, Math.min(cores(), mostWorkers, jobs));
    this.#workers = Array.from({ length: count }, () => this.#start(url));
    this.#watch = setInterval(() => this.#tick(), 1000);
  }

  #start(url) {
    const thread = new Worker(url, { resourceLimits: { maxOldGenerationSizeMb: heapMegabytes } });
    const worker = { thread, job: null, untaken: 0, silence: 0 };
    thread.on('message', (message) => this.#receive(worker, message));
    thread.on('error', (error) => this.#fail(worker, workerFailure(error)));
    thread.on('exit', () => this.#fail(worker, workerFailure(new Error('a thread ended'))));
    return worker;
  }

  /// Runs `jobs` (iterable) and calls `take(piece, job)` with every piece, in the order of the jobs. Ends early when it
  /// returns false.
  run(jobs, take) {
    return new Promise((resolve, reject) => {
      this.#run = { jobs: jobs[Symbol.iterator](), take, queue: [], stopped: false, resolve, reject };
      for (const worker of this.#workers) this.#give(worker);
      this.#settle();
    });
  }

  async close() {
    clearInterval(this.#watch);
    this.#run = null;
    await Promise.all(this.#workers.map(({ thread }) => thread.terminate()));
  }

  #give(worker) {
    const run = this.#run;
    // Far ahead of the job whose turn it is there is nothing to win.
    if (!run || run.stopped || worker.job || run.queue.length >= 4 * this.#workers.length) return;
    const next = run.jobs.next();
    if (next.done) {
      run.stopped = true;
      return;
    }
    worker.job = { job: next.value, worker, pieces: [], ended: false, failure: null };
    worker.silence = 0;
    run.queue.push(worker.job);
    worker.thread.postMessage(next.value);
  }

  #receive(worker, message) {
    worker.silence = 0;
    const entry = worker.job;
    if (message.kind === 'end' || message.kind === 'failed') {
      entry.ended = true;
      if (message.kind === 'failed') entry.failure = new ScanFailure(message.code, message.sentence);
      worker.job = null;
    } else {
      ++worker.untaken;
      entry.pieces.push(message);
    }
    this.#settle();
  }

  /// Takes what is due, then gives work to whoever has none.
  #settle() {
    const run = this.#run;
    if (!run) return;
    try {
      this.#takeDue(run);
    } catch (error) {
      this.#run = null;
      run.reject(error);
      return;
    }
    for (const worker of this.#workers) this.#give(worker);
    if (run.stopped && run.queue.length === 0) {
      this.#run = null;
      run.resolve();
    }
  }

  #takeDue(run) {
    while (run.queue.length > 0) {
      const first = run.queue[0];
      for (const piece of first.pieces.splice(0)) {
        if (!run.ignored && run.take(piece, first.job) === false) run.stopped = run.ignored = true;
        --first.worker.untaken;
        first.worker.thread.postMessage({ kind: 'taken' });
      }
      if (!first.ended) return;
      if (first.failure && !run.ignored) throw first.failure;
      run.queue.shift();
    }
  }

  #tick() {
    for (const worker of this.#workers)
      if (worker.job && worker.untaken === 0 && ++worker.silence > secondsOfSilence)
        this.#fail(worker, new ScanFailure(failureCode.malformed, `decoding ${worker.job.job.what} does not end`));
  }

  #fail(worker, failure) {
    const run = this.#run;
    this.#run = null;
    run?.reject(failure);
  }
}

function workerFailure(error) {
  if (error.code === 'ERR_WORKER_OUT_OF_MEMORY') return tooLarge('there is not enough memory to decode it');
  return new ScanFailure(failureCode.system, `decoding it failed: ${error.message}`);
}
