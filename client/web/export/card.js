// The dialog of exports; its words are those of page/strings/export.js.

export const card = `
<dialog id="exporting" aria-labelledby="exporting-title">
  <form method="dialog">
    <h2 id="exporting-title" data-text="title"></h2>
    <p id="export-guest" class="note" data-text="guest" hidden></p>
    <div id="export-points">
      <fieldset>
        <legend data-text="which"></legend>
        <label class="row"><input type="radio" name="export-region" value="all" checked><span data-text="regions.all"></span></label>
        <label class="row"><input type="radio" name="export-region" value="shapes"><span data-text="regions.shapes"></span></label>
        <label class="row"><input type="radio" name="export-region" value="polygon"><span data-text="regions.polygon"></span></label>
        <select id="export-outline" data-label="outline" hidden></select>
        <label class="row" id="export-classes-row"><input type="checkbox" id="export-classes" checked><span data-text="classes"></span></label>
        <label class="row" id="export-filter-row"><input type="checkbox" id="export-filter" checked><span data-text="filter"></span></label>
      </fieldset>
      <div class="row field"><label for="export-format" data-text="format"></label><select id="export-format"></select></div>
      <label class="row" data-tip="normalsTip"><input type="checkbox" id="export-normals"><span data-text="normals"></span></label>
      <p id="export-count" role="status"></p>
      <div class="buttons"><button type="button" id="export-save" data-text="save"></button></div>
    </div>
    <details id="rasters">
      <summary data-text="maps.rasters"></summary>
      <select id="raster-kind" data-label="maps.kind"></select>
      <select id="raster-extent" data-label="maps.extent"><option value="all" data-text="maps.extents.all"></option><option value="shown" data-text="maps.extents.shown"></option></select>
      <div class="row field"><label for="raster-cell" data-text="maps.cell"></label><input type="number" id="raster-cell" min="0" step="any" aria-describedby="raster-unit"><span id="raster-unit"></span></div>
      <p id="raster-refusal" class="refusal"></p>
      <p id="raster-size" class="note" role="status"></p>
      <p id="raster-alone" class="note" data-text="maps.alone" hidden></p>
      <div class="buttons"><button type="button" id="raster-save" data-text="maps.save"></button></div>
    </details>
    <details id="map-services">
      <summary data-text="maps.addresses"></summary>
      <p class="note" data-text="maps.how"></p>
      <p id="map-web" class="note" data-text="maps.noSystem" hidden></p>
      <p id="map-token" class="note" data-text="maps.token" hidden></p>
      <p id="map-said" class="note" role="status"></p>
    </details>
    <progress id="export-progress" max="1" data-label="progress" hidden></progress>
    <p id="export-state" class="note" role="status"></p>
    <div class="buttons">
      <button type="button" id="export-stop" data-text="cancel" hidden></button>
      <button type="button" id="export-close" data-text="close"></button>
    </div>
  </form>
</dialog>
`;
