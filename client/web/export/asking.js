// Asks a server for points (PROTOCOL.md, "Points of a region", "A profile").

const busy = [429, 503]; // others' work is under way, or what this page has just given up
const patience = [300, 700, 1500, 3000];

/** The same as post(), but asks again where the server is busy just now. */
export const postSoon = (server, cloud, what, question, signal) => soon(() => post(server, cloud, what, question, signal), signal);

/** What `ask()` resolves to, asked again where the server is busy just now. */
export async function soon(ask, signal) {
  for (const wait of [...patience, undefined]) {
    try {
      return await ask();
    } catch (/** @type {any} */ error) {
      if (!busy.includes(error.status) || wait === undefined || signal?.aborted) throw error;
      await new Promise((done) => { setTimeout(done, wait); });
      signal?.throwIfAborted();
    }
  }
  throw new Error('never');
}

/** The answer, a Response; rejects with what the server refuses with. `what`: 'profile' or 'points'. */
export const post = (server, cloud, what, question, signal) => server.ask(`/api/v1/clouds/${encodeURIComponent(cloud)}/${what}`, {
  method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(question), signal,
});
