// Where the scanner stood: a list in the panel, for clouds whose scan says it; choosing one goes there.

import { counted, strings } from './strings.js';

/** @type {(id: string) => any} */
const find = (id) => document.getElementById(id);
const mostListed = 500; // a longer menu helps nobody; the API has them all

/** "Tower, east (1.2 million points, 2 photos)". Pure. */
export function labelOfStation({ name, points, photos = [] }) {
  const has = [];
  if (points > 0) has.push(counted(points, 'point'));
  if (photos.length > 0) has.push(strings.photos.many(photos.length));
  return has.length > 0 ? `${name} (${has.join(', ')})` : name;
}

export class Stations {
  #server;
  #of; // id and revision of the cloud that the list is of, or is on its way for
  #list = [];

  /** `go(station)` gets one of the list, as the API has it. */
  constructor(server, go) {
    this.#server = server;
    find('station').addEventListener('change', (event) => {
      const station = this.#list[Number(event.target.value)];
      // The menu names what one may go to, not where one is: one leaves the place with the next drag.
      event.target.value = '';
      if (station) go(station);
    });
  }

  /** The list of this cloud, `undefined`: of none. A cloud without stations, or a server that does not tell, has no list. */
  async show(cloud) {
    const of = cloud?.stations > 0 ? `${cloud.id} ${cloud.revision}` : undefined;
    if (of === this.#of) return;
    this.#of = of;
    this.#fill([]);
    if (!of) return;
    try {
      const list = await this.#server.stations(cloud.id);
      if (this.#of === of) this.#fill(list);
    } catch {
      if (this.#of === of) this.#of = undefined; // asked for again with the next change
    }
  }

  #fill(list) {
    this.#list = list.slice(0, mostListed);
    find('stations').hidden = this.#list.length === 0;
    find('station').replaceChildren(
      new Option(strings.stations.choose, ''),
      ...this.#list.map((station, i) => new Option(labelOfStation(station), String(i))),
    );
  }
}
