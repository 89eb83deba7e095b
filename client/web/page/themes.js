// Light, dark, or as the system has it: remembered in this browser. index.html runs this file before anything is painted, so
// that a dark page never begins with a white flash; it imports nothing for that reason.

const key = 'scancast-theme';
export const themes = ['system', 'light', 'dark'];

/** The theme that was chosen; 'system' where none was, or where this browser keeps nothing. */
export function chosenTheme() {
  try {
    const kept = localStorage.getItem(key);
    return themes.includes(kept) ? kept : 'system';
  } catch {
    return 'system'; // storage may be forbidden
  }
}

function show(theme) {
  if (theme === 'system') delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  // The browser's own bar above the page.
  const dark = theme === 'dark' || (theme === 'system' && !matchMedia('(prefers-color-scheme: light)').matches);
  document.querySelector('meta[name="theme-color"]')?.setAttribute('content', dark ? '#1a1f26' : '#ffffff');
}

export function chooseTheme(theme) {
  if (!themes.includes(theme)) return;
  try {
    if (theme === 'system') localStorage.removeItem(key);
    else localStorage.setItem(key, theme);
  } catch {
    // Then it holds until the page is left.
  }
  show(theme);
}

if (typeof document !== 'undefined') {
  show(chosenTheme());
  matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => show(chosenTheme()));
  // Another tab of this page.
  addEventListener('storage', (event) => event.key === key && show(chosenTheme()));
}
