// Asks a server for points (PROTOCOL.md, "Points of a region", "A profile").

/** The answer, a Response; rejects with what the server refuses with. `what`: 'profile' or 'points'. */
export const post = (server, cloud, what, question, signal) => server.ask(`/api/v1/clouds/${encodeURIComponent(cloud)}/${what}`, {
  method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(question), signal,
});
