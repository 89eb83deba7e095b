// Files in and out: exports and the project as downloads, a project that is opened or dropped onto the page.

import { downloadBlob } from '../export/saving.js';
import { mostBytes, parseProject, ProjectError } from './project.js';

/** Hands a text to the browser as a download. */
export function download(name, type, text) {
  downloadBlob(name, new Blob([text], { type }));
}

/** The project in a File; rejects with a ProjectError. */
export async function readProject(file) {
  if (file.size > mostBytes) throw new ProjectError(`${file.name} is larger than ${mostBytes >> 20} MiB, which no project file is.`);
  let text;
  try {
    text = await file.text();
  } catch {
    throw new ProjectError(`${file.name} could not be read.`);
  }
  return parseProject(text);
}

/** `use(file)` hears of what is chosen with `button`. */
export function acceptFiles(button, input, use) {
  button.addEventListener('click', () => input.click());
  input.addEventListener('change', () => {
    if (input.files[0]) use(input.files[0]);
    input.value = ''; // so that the same one can be chosen again
  });
}
