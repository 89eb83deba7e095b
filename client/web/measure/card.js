// The card of measuring, as page/lazy_tools.js puts it beside the rail; its words are those of page/strings/measure.js.

export const card = `
<section id="measuring" class="card" aria-labelledby="measuring-title" hidden>
  <header>
    <h2 id="measuring-title" data-text="title"></h2>
    <button type="button" id="close-measuring" data-label="close" data-tip="close">✕</button>
  </header>
  <div id="measure-kinds" class="tiles" role="radiogroup" data-label="kind"></div>
  <p id="measure-how" class="note"></p>
  <div id="measure-draft" class="row" hidden>
    <button type="button" id="measure-done" data-text="done"></button>
    <button type="button" id="measure-take-back" data-text="takeBack"></button>
    <button type="button" id="measure-cancel" data-text="cancel"></button>
  </div>
  <div class="rest">
    <div class="row heading">
      <h3 id="measure-list-title" data-text="list"></h3>
      <button type="button" id="measure-undo" data-label="undo" data-tip="undoTip" disabled></button>
      <button type="button" id="measure-redo" data-label="redo" data-tip="redoTip" disabled></button>
    </div>
    <p id="measure-none" class="note" data-text="none"></p>
    <ul id="measure-list" class="entries" aria-labelledby="measure-list-title" hidden></ul>
    <div id="measure-unit" class="segments" role="radiogroup" data-label="unit"></div>
    <p id="measure-no-unit" class="note" data-text="unitUnknown" hidden></p>
    <details id="measure-files">
      <summary data-text="files"></summary>
      <div class="buttons">
        <button type="button" id="export-csv" data-tip="csvTip">CSV</button>
        <button type="button" id="export-dxf" data-tip="dxfTip">DXF</button>
        <button type="button" id="export-geojson" data-tip="geoJsonTip" hidden>GeoJSON</button>
        <button type="button" id="save-project" data-tip="saveProjectTip" data-text="saveProject"></button>
        <button type="button" id="open-project" data-tip="openProjectTip" data-text="openProject"></button>
        <input type="file" id="project-file" accept=".json,application/json" hidden>
      </div>
      <p id="export-no-system" class="note" data-text="noSystem" hidden></p>
    </details>
  </div>
  <p id="measure-said" role="status"></p>
</section>
`;
