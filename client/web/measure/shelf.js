// What the browser keeps of a scan between visits: its project, one for each cloud and state of it (`revision`).

import { deviceStore } from '../connection/stores.js';
import { indexKey, keptKeys, keyBegin } from './beginning.js';
import { parseProject } from './project.js';

const mostKept = 40; // projects on one device; the oldest go
const keyOf = (cloud) => `${keyBegin(cloud)}${cloud.revision ?? ''}`;

function read(key) {
  const text = deviceStore.get(key);
  if (!text) return undefined;
  try {
    return parseProject(text);
  } catch {
    return undefined; // by whomever: it is not to stop the page
  }
}

/**
 * { project, isOlder }: what is kept of that cloud, be it of an earlier state of it; { isUnreadable } where there is something that cannot be read,
 * which is set aside; undefined for nothing.
 */
export function recall(cloud) {
  const own = keyOf(cloud);
  const project = read(own);
  if (project) return { project, isOlder: false };
  const text = deviceStore.get(own);
  if (text) {
    deviceStore.set(`${own}.unreadable`, text);
    deviceStore.remove(own);
  }
  const earlier = keptKeys().findLast((key) => key.startsWith(keyBegin(cloud)) && read(key));
  return earlier ? { project: read(earlier), isOlder: true } : text ? { project: undefined, isOlder: false, isUnreadable: true } : undefined;
}

/** `text` as printProject() makes it; an empty one is forgotten. */
export function keep(cloud, text) {
  const key = keyOf(cloud);
  const others = keptKeys().filter((one) => one !== key);
  if (text) {
    others.push(key);
    deviceStore.set(key, text);
  } else deviceStore.remove(key);
  for (const old of others.splice(0, Math.max(0, others.length - mostKept))) deviceStore.remove(old);
  deviceStore.set(indexKey, JSON.stringify(others));
}
