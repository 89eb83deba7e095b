// The card of notes, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/annotate.js.

export const card = `
<section id="annotating" class="card" aria-labelledby="annotating-title" hidden>
  <header>
    <h2 id="annotating-title" data-text="title"></h2>
    <button type="button" id="close-annotating" data-label="close" data-tip="close">✕</button>
  </header>
  <p id="note-how" class="note"></p>
  <div class="row heading">
    <h3 id="note-list-title" data-text="list"></h3>
    <button type="button" id="note-undo" data-label="undo" data-tip="undoTip" disabled></button>
    <button type="button" id="note-redo" data-label="redo" data-tip="redoTip" disabled></button>
  </div>
  <p id="note-none" class="note" data-text="none"></p>
  <ul id="note-list" class="entries" aria-labelledby="note-list-title" hidden></ul>
  <details>
    <summary data-text="files"></summary>
    <div class="buttons">
      <button type="button" id="note-save-project" data-tip="saveProjectTip" data-text="saveProject"></button>
      <button type="button" id="note-open-project" data-tip="openProjectTip" data-text="openProject"></button>
    </div>
    <p class="note" data-text="exports"></p>
  </details>
  <p id="note-said" role="status"></p>
</section>
`;
