// The card of filters by values, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/filter.js.

export const card = `
<section id="filtering" class="card" aria-labelledby="filtering-title" hidden>
  <header>
    <h2 id="filtering-title" data-text="title"></h2>
    <button type="button" id="close-filtering" data-label="close" data-tip="close">✕</button>
  </header>
  <p class="note" data-text="how"></p>
  <p id="filter-state" class="note" role="status"></p>
  <ul id="filter-list" class="entries" data-label="list"></ul>
  <div class="buttons"><button type="button" id="filter-none" data-text="none"></button></div>
</section>
`;
