// The card of cutting, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/clip.js.

export const card = `
<section id="clipping" class="card" aria-labelledby="clipping-title" hidden>
  <header>
    <h2 id="clipping-title" data-text="title"></h2>
    <button type="button" id="close-clipping" data-label="close" data-tip="close">✕</button>
  </header>
  <p class="note" data-text="how"></p>
  <p id="clip-empty" class="note" data-text="empty"></p>
  <ul id="clip-list" class="entries" data-label="list"></ul>
  <div class="buttons">
    <button type="button" id="clip-add" data-text="add"></button>
    <button type="button" id="clip-add-plane" data-text="addPlane"></button>
    <button type="button" id="clip-none" data-text="none"></button>
  </div>
</section>
`;
