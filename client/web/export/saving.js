// An answer that is a file, saved while it comes: into a file that the user has chosen, where the browser lets him (Chromium, on https and on this
// machine); else into a Blob, which browsers move out of memory, and which is handed over as a download when all of it is there.

/** What a browser is asked to take that has no files to write into: more than this is said to be too much. */
export const mostInBlob = 2e9;

const types = { las: 'application/vnd.las', ply: 'application/octet-stream', csv: 'text/csv', txt: 'text/plain', png: 'image/png', tif: 'image/tiff' };

let isRefused = false; // a browser that could, and may not here: a page within another website's

/** Whether files can be written while they come, as far as one knows before one tries. */
export const writesFiles = () => typeof globalThis.showSaveFilePicker === 'function' && !isRefused;

/** Hands a Blob to the browser as a download. */
export function downloadBlob(name, blob) {
  const url = URL.createObjectURL(blob);
  Object.assign(document.createElement('a'), { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/**
 * Where the file is to go: { name, isBlob, begin(), discard() }; undefined where the user chose none. To be called by a click, before anything is awaited.
 * `begin()` resolves to { write(chunk), close(), abort() }; `discard()` is for a target that has not begun: no empty file is to stay.
 */
export async function chooseTarget(name, format) {
  if (!writesFiles()) return blobsPlace(name, format);
  try {
    const handle = await /** @type {any} */ (globalThis).showSaveFilePicker({
      suggestedName: name, types: [{ accept: { [types[format] ?? 'application/octet-stream']: [`.${format}`] } }],
    });
    const discard = async () => handle.remove?.().catch(() => {}); // it was made, empty, when it was chosen
    return { name: handle.name, isBlob: false, discard, async begin() {
      const file = await handle.createWritable();
      return {
        write: (chunk) => file.write(chunk),
        close: () => file.close(),
        async abort() {
          await file.abort().catch(() => {});
          await discard();
        },
      };
    } };
  } catch (/** @type {any} */ error) {
    if (error.name === 'AbortError') return undefined;
    isRefused = true;
    return blobsPlace(name, format);
  }
}

const blobsPlace = (name, format) => ({ name, isBlob: true, discard: async () => {}, begin: async () => blobTarget(name, format) });

/** A stream of chunks becomes a Blob, outside of the page's own memory where the browser can. */
function blobTarget(name, format) {
  const { readable, writable } = new TransformStream();
  const blob = new Response(readable, { headers: { 'Content-Type': types[format] ?? 'application/octet-stream' } }).blob();
  blob.catch(() => {});
  const writer = writable.getWriter();
  return {
    write: (chunk) => writer.write(chunk),
    async close() {
      await writer.close();
      downloadBlob(name, await blob);
    },
    abort: () => writer.abort().catch(() => {}),
  };
}

/**
 * The answer's body into a target of chooseTarget(); `told(bytes)` hears how far it is. Rejects where the answer breaks off - it is not all of the file then,
 * and nothing is left of it -, where `signal` is aborted, and where it becomes more than there is room for. Resolves to the number of bytes.
 */
export async function save(response, target, told, signal) {
  const sink = await target.begin();
  const reader = response.body.getReader();
  const end = () => reader.cancel().catch(() => {});
  signal?.addEventListener('abort', end, { once: true });
  let bytes = 0;
  try {
    for (;;) {
      const { done, value } = await reader.read();
      signal?.throwIfAborted();
      if (done) break;
      bytes += value.length;
      if (target.isBlob && bytes > mostInBlob) throw new RangeError('more than this browser takes');
      await sink.write(value);
      told(bytes);
    }
    await sink.close();
    return bytes;
  } catch (error) {
    end();
    await sink.abort();
    throw error;
  } finally {
    signal?.removeEventListener('abort', end);
  }
}

/** The same for an answer that is asked for by `ask()`; where that is refused, nothing stays of the target. */
export async function saveAnswer(ask, target, told, signal) {
  let response;
  try {
    response = await ask();
  } catch (error) {
    await target.discard();
    throw error;
  }
  return { response, bytes: await save(response, target, told, signal) };
}
