// Saved views and tours as a project file has them. They may come from anywhere, so everything is checked. Pure.
//
// A saved view is { id, name, view }: `view` in the words of an address, as behind its #. A tour is { id, name, views, seconds, pause, loop }:
// which views, all of them in their order where `views` is undefined; seconds from one to the next, and seconds at each. A file names the
// views of a tour; here it has their ids, so that it holds whatever they are called, and whoever takes back a deletion has his tour again.

import { check, isText, listOf } from '../measure/checks.js';

export const mostViews = 200;
export const mostTours = 20;
export const mostStops = 500;
export const longestName = 120;
export const longestView = 4096;
export const usualTour = { name: 'Tour', views: undefined, seconds: 4, pause: 2, loop: false };
export const secondsRange = { least: 0.2, most: 600 };
export const pauseRange = { least: 0, most: 600 };

const isWithin = (value, { least, most }) => typeof value === 'number' && value >= least && value <= most;

function nameOf(name, where, known) {
  check(isText(name, longestName) && name.trim() !== '', `${where}.name is no text of up to ${longestName} letters.`);
  check(!known.has(name), `${where}.name: there are two of the name ${JSON.stringify(name)}.`);
  known.add(name);
  return name;
}

export function readViews(file) {
  const names = new Set();
  return listOf(file, 'views', mostViews, ({ name, view }, where) => {
    check(isText(view, longestView) && view !== '', `${where}.view is no text of up to ${longestView} letters.`);
    return { name: nameOf(name, where, names), view };
  });
}

/** `views`: those of the file. */
export function readTours(file, views) {
  const known = new Set(views.map(({ name }) => name));
  const names = new Set();
  return listOf(file, 'tours', mostTours, ({ name, views: stops, seconds = usualTour.seconds, pause = usualTour.pause, loop = false }, where) => {
    nameOf(name, where, names);
    check(isWithin(seconds, secondsRange), `${where}.seconds is not between ${secondsRange.least} and ${secondsRange.most}.`);
    check(isWithin(pause, pauseRange), `${where}.pause is not between ${pauseRange.least} and ${pauseRange.most}.`);
    check(typeof loop === 'boolean', `${where}.loop is neither true nor false.`);
    check(stops === undefined || (Array.isArray(stops) && stops.length <= mostStops), `${where}.views is no list of up to ${mostStops} names.`);
    stops?.forEach((stop, i) => check(known.has(stop), `${where}.views[${i}]: there is no view ${JSON.stringify(stop)?.slice(0, 140)} in the file.`));
    return { name, views: stops, seconds, pause, loop };
  });
}

export const writtenViews = (list) => list.map(({ name, view }) => ({ name, view }));
/** Tours as a file has them, with the views that it has. */
export function writtenTours(list, views) {
  const names = new Map(views.map(({ id, name }) => [id, name]));
  return list.map(({ name, views: stops, seconds, pause, loop }) => (
    { name, views: stops?.filter((id) => names.has(id)).map((id) => names.get(id)), seconds, pause, ...(loop ? { loop } : {}) }));
}

/** Tours of a file, with the ids that its views have been given. */
export function toursOf(tours, views) {
  const ids = new Map(views.map(({ id, name }) => [name, id]));
  return tours.map((tour) => ({ ...tour, views: tour.views?.map((name) => ids.get(name)) }));
}

/** The views that a tour leads along, in its order. */
export const stopsOf = (tour, views) => (tour.views ? tour.views.map((id) => views.find((one) => one.id === id)).filter(Boolean) : views);
