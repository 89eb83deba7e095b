// Taking a view along as a link.

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
