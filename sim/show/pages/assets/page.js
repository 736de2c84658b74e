// Puts the page together.

function showProblems(data) {
  const list = byId("problems");
  list.append(...data.failures.map((failure) => element("li", {}, failure)));
  const rejected = data.controllers.filter((controller) => controller.untrusted_samples > 0);
  if (rejected.length > 0) {
    const counts = rejected.map((controller) => controller.untrusted_samples);
    const [least, most] = [Math.min(...counts), Math.max(...counts)];
    const who = rejected.length === 1 ? rejected[0].name
      : rejected.length === data.controllers.length ? "All controllers"
      : `${rejected.length} of ${data.controllers.length} controllers`;
    list.append(element("li", {}, `${who}: ${least === most ? "" : `${least} to `}${most} glove ` +
      "samples were rejected (missing, out of range, spike or frozen); the last valid value was held"));
  }
  list.hidden = list.children.length === 0;
}

function startVideo(clock, replay) {
  const section = byId("video");
  const start = (video) => {
    const shared = new SharedVideo(video, JSON.parse(section.dataset.stretches), clock);
    shared.onPause = () => replay?.play(false);
    if (replay) replay.video = shared;
  };
  const drawn = section.querySelector("video");
  if (drawn) start(drawn);
  // Not asked for until a person does: a file that is not there would be an error.
  byId("video-show")?.addEventListener("click", () => {
    const video = element("video", {controls: true, muted: true, playsinline: true, preload: "metadata",
      src: "comparison.mp4", "aria-label": "The hands of several controllers side by side"});
    byId("video-place").replaceChildren(video);
    start(video);
  });
}

// Dots in the colours of the controllers, before their names in the table of the verdict.
function markNames(data) {
  for (const head of byId("numbers").querySelectorAll("tbody th")) {
    const c = data.controllers.findIndex(({name}) => name === head.textContent);
    if (c >= 0) head.replaceChildren(...controllerLabel(data, c));
  }
}

// The versions stand at the end of the settings, below `made_with`.
function showVersions() {
  const place = byId("versions");
  const block = /^made_with:\n((?:[ ].*\n?)+)/m.exec(byId("settings-text").textContent);
  for (const [, key, value] of (block ? block[1] : "").matchAll(/^  (\w+): "(.*)"$/gm)) {
    place.append(element("dt", {}, key.replaceAll("_", " ")), element("dd", {}, value));
  }
}

function startSettings() {
  showVersions();
  const button = byId("settings-copy");
  button.hidden = !navigator.clipboard;
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(byId("settings-text").textContent);
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
}

// Charts take their width and colours when drawn: draw again when these change.
function followScreen(redraw) {
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    redraw();
  });
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", redraw);
  window.addEventListener("beforeprint", () => {
    document.documentElement.dataset.paper = "";
    // Paper is light. What is light already stays: a canvas drawn now may miss the print.
    if (dark.matches) redraw();
  });
  window.addEventListener("afterprint", () => {
    delete document.documentElement.dataset.paper;
    if (dark.matches) redraw();
  });
}

function hidePart(id) {
  byId(id).hidden = true;
  document.querySelector(`nav a[href="#${id}"]`).hidden = true;
}

// The view is in the address, to be sent or kept: #channel=index_mcp&view=error&t=2.600.
function followAddress(curves, clock) {
  const apply = () => {
    const asked = new URLSearchParams(location.hash.slice(1));
    const has = (select, value) => [...select.options].some((option) => option.value === value);
    if (has(curves.view, asked.get("view"))) curves.view.value = asked.get("view");
    if (has(curves.select, asked.get("channel"))) curves.select.value = asked.get("channel");
    else if (!asked.has("view") && !asked.has("t")) return;  // a part of the page
    curves.show();
    const time = Number.parseFloat(asked.get("t"));
    if (Number.isFinite(time)) clock.set(time, "address", true);
    if (asked.has("channel")) byId("curves").scrollIntoView();
  };
  apply();
  window.addEventListener("hashchange", apply);
  const tell = (time) => {
    const view = new URLSearchParams({channel: curves.select.value, view: curves.view.value});
    if (time !== null) view.set("t", time.toFixed(3));
    history.replaceState(null, "", `#${view}`);
  };
  curves.onView = () => tell(null);
  clock.listen("address", (time, settled) => { if (settled) tell(time); });
}

function startCurves(data, clock) {
  byId("curves-note").textContent = curvesNote(data);
  let spectra = null;
  const curves = new CurvesView(data, clock, (name, channel) => {
    markChannel(name);
    spectra?.show(channel);
  });
  byId("curves-readout").parentElement.after(
    saveButtons(data, "curves", () => curves.figure(), () => curves.table()));
  if (curves.store.bucketed) {  // what a bucket hides is what a spectrum is about
    hidePart("spectra");
    return curves;
  }
  spectra = new SpectraView(data, curves.store);
  spectra.show(curves.select.selectedIndex);
  return curves;
}

function start() {
  const data = JSON.parse(byId("data").textContent);
  colours = data.controllers.map(({colour}) => colour);
  showProblems(data);
  const clock = new SharedTime();
  let curves = null;
  const drawHeatMap = startHeatMap(data, (name) => {
    if (!curves) return;
    curves.selectChannel(name);
    byId("curves").scrollIntoView();
  });
  const drawTables = () => {
    if (data.switched) drawSwitched(data);
    if (data.error_split) drawErrorSplit(data);
    drawScoreTable(data);
    if (data.latency) drawLatency(data);
    drawHeatMap();
  };
  startOrder(data, drawTables);
  drawTables();
  if (data.switched) startSwitched(data);
  if (data.error_split) startErrorSplit(data);
  else byId("error-shares").hidden = true;
  if (!data.switched && !data.error_split) hidePart("error");
  if (!data.latency) hidePart("latency");
  if (!byId("recording")) document.querySelector('nav a[href="#recording"]').hidden = true;
  byId("scores-table").parentElement.after(saveButtons(data, "scores", null, () => scoreRows(data)));
  if (data.latency) {
    byId("latency-table").parentElement.after(saveButtons(data, "latency", null, () => latencyRows(data)));
  }
  markNames(data);
  startFrontChart(data);
  let drawSeeds = () => {};
  if (data.seeds.length > 1) drawSeeds = startSeeds(data);
  else hidePart("seeds");
  if (data.curves) {
    curves = startCurves(data, clock);
  } else {
    hidePart("curves");
    hidePart("spectra");
  }
  const replay = startReplay(data, curves, clock);
  startVideo(clock, replay);
  if (curves) followAddress(curves, clock);
  startSettings();
  followScreen(() => {
    if (data.error_split) drawErrorBars(data);
    drawSeeds();
    curves?.show();
    replay?.redraw();
  });
}

start();
