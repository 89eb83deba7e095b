// What the server says about its clouds and methods, over HTTP.

import { authorization } from './access.js';

const patienceMs = 10_000;

/** An answer that is an error, in words that a person can read. */
export class ServerProblem extends Error {
  constructor(problem) {
    super(problem.detail || problem.title || 'The server could not do this.');
    this.title = problem.title ?? 'The server refused the request';
    this.status = problem.status ?? 0;
  }
}

/** The problem in a failed answer, whatever its body is. */
export async function problemOf(response) {
  let problem = {};
  try {
    problem = await response.json();
  } catch {
    // No JSON: a proxy's own page, or nothing at all.
  }
  return new ServerProblem({
    status: response.status,
    title: problem.title ?? `The server answered ${response.status}`,
    detail: problem.detail,
  });
}

async function getJson(path) {
  const response = await fetch(path, { signal: AbortSignal.timeout(patienceMs), cache: 'no-cache', headers: authorization() });
  if (!response.ok) throw await problemOf(response);
  return response.json();
}

const listOf = (value) => (Array.isArray(value) ? value : []);

/** { clouds, pending }: those that can be looked at, and those that are loading or failed. */
export async function fetchClouds() {
  const body = await getJson('/api/v1/clouds');
  return { clouds: listOf(body.clouds), pending: listOf(body.pending) };
}

/** Views that show most of the cloud, the best first, complete and fitted to a picture of this size: [{ name, inside, view }]. */
export async function fetchViews(cloud, { width, height }) {
  const body = await getJson(`/api/v1/clouds/${encodeURIComponent(cloud)}/views?width=${width}&height=${height}`);
  return listOf(body.views);
}

/** Where the scanner stood, each with the view from there. */
export async function fetchStations(cloud) {
  const body = await getJson(`/api/v1/clouds/${encodeURIComponent(cloud)}/stations`);
  return listOf(body.stations);
}

/** The photos that the scan brought along; those that say from where they were taken have a view, which fits a picture of this size. */
export async function fetchPhotos(cloud, { width, height }) {
  const body = await getJson(`/api/v1/clouds/${encodeURIComponent(cloud)}/photos?width=${width}&height=${height}`);
  return listOf(body.photos);
}

/** { methods, colors, colormaps, shadings }. */
export async function fetchMethods() {
  const body = await getJson('/api/v1/methods');
  return {
    methods: listOf(body.methods),
    colors: listOf(body.colors),
    colormaps: listOf(body.colormaps),
    shadings: listOf(body.shadings),
  };
}
