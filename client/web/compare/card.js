// The card of comparing, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/compare.js.

const field = (name) => `
  <label class="row field"><span data-text="${name}"></span><select id="compare-${name}"></select></label>`;

export const card = `
<section id="comparing" class="card" aria-labelledby="comparing-title" hidden>
  <header>
    <h2 id="comparing-title" data-text="title"></h2>
    <button type="button" id="close-comparing" data-label="close" data-tip="close">✕</button>
  </header>
  <p class="note" data-text="how"></p>
  <p id="compare-begins" role="status"></p>
  <h3 data-text="right"></h3>${['method', 'color', 'shading', 'classes', 'cloud'].map(field).join('')}
</section>
`;
