// Taking a view along: as a link, and as a picture file.

import { strings } from './strings.js';

/** Puts the address, which holds the view, into the clipboard. */
export async function copyLink(overlays) {
  try {
    await navigator.clipboard.writeText(location.href);
    overlays.toast(strings.messages.linkCopied, strings.messages.linkCopiedDetail, 'done');
  } catch {
    // Without https, or without permission, the clipboard is out of reach; the address bar is not.
    overlays.toast(strings.messages.linkInAddress, strings.messages.linkInAddressDetail, 'done');
  }
}

/** Asks the server for the view in full quality and hands it to the browser as a download. */
export async function savePicture(server, cloud, view, size, overlays) {
  try {
    const url = URL.createObjectURL(await server.snapshot(cloud, view, size));
    Object.assign(document.createElement('a'), { href: url, download: `${cloud}.png` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
    overlays.toast(strings.messages.pictureSaved, strings.messages.pictureSavedDetail(`${cloud}.png`, size.width, size.height), 'done');
  } catch (/** @type {any} */ error) {
    const known = error.title !== undefined;
    overlays.toast(known ? error.title : strings.messages.pictureFailed, known ? (error.message === error.title ? '' : error.message) : strings.messages.noAnswer);
  }
}
