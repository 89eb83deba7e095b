// The card of clouds that are shown together, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/together.js.

export const card = `
<section id="together" class="card" aria-labelledby="together-title" hidden>
  <header>
    <h2 id="together-title" data-text="title"></h2>
    <button type="button" id="close-together" data-label="close" data-tip="close">✕</button>
  </header>
  <ul id="together-list" class="entries" data-label="list"></ul>
  <div class="buttons">
    <button type="button" id="together-color" aria-pressed="false" data-text="color"></button>
    <button type="button" id="together-fit" data-text="fit"></button>
    <button type="button" id="together-none" data-text="alone"></button>
  </div>
  <h3 id="together-others-title" data-text="others"></h3>
  <input type="search" id="together-search" data-label="search" data-hint="search" hidden>
  <ul id="together-others" class="entries" aria-labelledby="together-others-title"></ul>
  <p id="together-state" class="note" role="status"></p>
</section>
`;
