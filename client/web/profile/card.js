// The card of profiles, as page/lazy_tools.js puts it beside the rail, and the panel below the picture; their words are those of
// page/strings/profile.js.

export const card = `
<section id="profiling" class="card" aria-labelledby="profiling-title" hidden>
  <header>
    <h2 id="profiling-title" data-text="title"></h2>
    <button type="button" id="close-profiling" data-label="close" data-tip="close">✕</button>
  </header>
  <p id="profile-how" class="note"></p>
  <div class="row field"><label for="profile-width" data-text="width" data-tip="widthTip"></label>
    <input type="number" id="profile-width" step="any" min="0"><span id="profile-unit" class="unit"></span>
  </div>
  <div id="profile-draft" class="buttons" hidden>
    <button type="button" id="profile-done" data-text="done"></button>
    <button type="button" id="profile-take-back" data-text="takeBack"></button>
    <button type="button" id="profile-cancel" data-text="cancel"></button>
  </div>
  <p id="profile-said" role="status"></p>
</section>

<section id="profile-panel" data-label="panel" hidden>
  <div id="profile-resize" role="separator" aria-orientation="horizontal" tabindex="0" data-own-keys data-label="resize"></div>
  <header>
    <h2 data-text="title"></h2>
    <button type="button" id="profile-again" data-text="again"></button>
    <button type="button" id="profile-only" data-text="onlyThis" data-tip="onlyThisTip"></button>
    <button type="button" id="profile-save" popovertarget="profile-files" data-text="save" data-tip="saveTip"></button>
    <button type="button" id="profile-stop" data-text="stop" hidden></button>
    <span class="space"></span>
    <select id="profile-exaggeration" data-label="exaggeration" data-tip="exaggeration"></select>
    <button type="button" id="profile-farther" data-label="farther" data-tip="farther">−</button>
    <button type="button" id="profile-closer" data-label="closer" data-tip="closer">+</button>
    <button type="button" id="profile-fit" data-label="fit" data-tip="fit">
      <svg viewBox="0 0 24 24" aria-hidden="true"><path d="M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5"/></svg>
    </button>
    <button type="button" id="profile-close" data-label="close" data-tip="close">✕</button>
  </header>
  <div id="profile-files" popover>
    <button type="button" data-format="csv" data-text="saveAs.csv"></button>
    <button type="button" data-format="las" data-text="saveAs.las"></button>
    <button type="button" data-format="ply" data-text="saveAs.ply"></button>
    <button type="button" data-format="png" data-text="saveAs.png"></button>
  </div>
  <div id="profile-stage">
    <canvas id="profile-plot" tabindex="0" data-own-keys role="img" data-label="plot"></canvas>
    <p id="profile-state" role="status"></p>
  </div>
  <footer><span id="profile-at"></span><span id="profile-measured" role="status"></span></footer>
</section>
`;
