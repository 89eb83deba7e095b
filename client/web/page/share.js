// Taking a view along: as a link, and as a picture file.

import { authorization } from '../connection/access.js';
import { problemOf } from '../connection/catalog.js';
import { snapshotUrl } from '../protocol/view_words.js';

/** Puts the address, which holds the view, into the clipboard. */
export async function copyLink(overlays) {
  try {
    await navigator.clipboard.writeText(location.href);
    overlays.toast('Link copied', 'It shows this very view.', 'done');
  } catch {
    // Without https, or without permission, the clipboard is out of reach; the address bar is not.
    overlays.toast('The link is in the address bar', 'Copy it from there: it shows this very view.', 'done');
  }
}

/** Asks the server for the view in full quality and hands it to the browser as a download. */
export async function savePicture(cloud, view, { width, height }, overlays) {
  try {
    const response = await fetch(snapshotUrl(cloud, view, width, height), { headers: authorization() });
    if (!response.ok) throw await problemOf(response);
    const url = URL.createObjectURL(await response.blob());
    Object.assign(document.createElement('a'), { href: url, download: `${cloud}.png` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
    overlays.toast('Picture saved', `${cloud}.png, ${width} × ${height}`, 'done');
  } catch (error) {
    const known = error.title !== undefined;
    overlays.toast(known ? error.title : 'The picture could not be saved', known ? error.message : 'The server does not answer.');
  }
}
