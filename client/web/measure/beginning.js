// What the page knows of measures before measuring has been loaded: whether an address, or this device, has any of a scan; and that files
// may be dropped onto it. Measuring itself comes for these, or when it is first used (page/lazy_tools.js).

import { deviceStore } from '../connection/stores.js';

/** Of the address, before its `=`. */
export const linkWord = 'measures';
export const indexKey = 'scancast.projects';
/** Of the keys under which a scan's projects are kept; each ends with a state of it. */
export const keyBegin = ({ id }) => `scancast.project.${id}@`;

/** Keys of the projects that are kept, the oldest first. */
export function keptKeys() {
  try {
    const list = JSON.parse(deviceStore.get(indexKey) ?? '[]');
    return Array.isArray(list) ? list.filter((key) => typeof key === 'string') : [];
  } catch {
    return [];
  }
}

/** Whether this device keeps measures of that scan, be it of an earlier state. */
export const keepsSome = (cloud) => keptKeys().some((key) => key.startsWith(keyBegin(cloud)));

/** `measures=…` as an address's hash has it; '' where it has none. Pure. */
export const measuresIn = (hash) => String(hash ?? '').replace(/^#/, '').split('&').find((one) => one.startsWith(`${linkWord}=`)) ?? '';

const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes('Files');

/** `use(file)` hears of a file that is dropped anywhere. */
export function acceptDrops(use) {
  addEventListener('dragover', (event) => hasFiles(event) && event.preventDefault());
  addEventListener('drop', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault(); // the browser would leave the page for it
    const [file] = event.dataTransfer.files;
    if (file) use(file);
  });
}
