// Saved views and tours as a project file has them. They may come from anywhere, so everything is checked. Pure.
//
// A saved view is { id, name, view }: `view` in the words of an address, as behind its #. A tour is { id, name, views, seconds, pause, loop }:
// names of views, all of them in their order where `views` is undefined; seconds from one to the next, and seconds at each.

import { check, isText, listOf } from '../measure/checks.js';

export const mostViews = 200;
export const mostTours = 20;
export const mostStops = 500;
export const longestName = 120;
const longestView = 4096;
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
export const writtenTours = (list) => list.map(({ name, views, seconds, pause, loop }) => ({ name, views, seconds, pause, ...(loop ? { loop } : {}) }));

/** The views that a tour leads along, in its order. */
export const stopsOf = (tour, views) => (tour.views ? tour.views.map((name) => views.find((one) => one.name === name)).filter(Boolean) : views);

/** Tours in which a view has another name, or, without one, is no more. */
export const toursWith = (tours, name, next) => tours.map(({ id, ...tour }) => (
  { ...tour, views: tour.views?.flatMap((one) => (one !== name ? [one] : next === undefined ? [] : [next])) }));
