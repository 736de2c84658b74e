// Puts the page together.

function showProblems(data) {
  const list = byId("problems");
  list.append(...data.failures.map((failure) => element("li", {}, failure)));
  for (const controller of data.controllers) {
    if (controller.untrusted_samples > 0) {
      list.append(element("li", {}, `${controller.name}: ${controller.untrusted_samples} glove ` +
        "samples were rejected (missing, out of range, spike or frozen); the last valid value was held"));
    }
  }
  list.hidden = list.children.length === 0;
}

// Runs together with the curves, if there are any: it moves their cursor, and a click there moves it.
function videoElement(curves) {
  const video = element("video", {controls: true, preload: "metadata", playsinline: true,
    src: "comparison.mp4", "aria-label": "The hands of all controllers side by side"});
  const starts_s = Number(byId("video").dataset.motionStarts);
  video.addEventListener("timeupdate", () => curves?.showTime(video.currentTime - starts_s));
  if (curves) curves.onTime = (time_s) => { video.currentTime = time_s + starts_s; };
  return video;
}

function startVideo(curves) {
  const place = byId("video-place");
  if (byId("video").dataset.video === "drawn") {
    place.append(element("p", {class: "note"},
      "All controllers side by side, in comparison.mp4 beside this page. It moves the cursor of the " +
      "curves; a click into them moves it."), videoElement(curves));
    return;
  }
  // Not asked for until a person does: a file that is not there would be an error.
  place.append(element("p", {class: "note"}, "None was drawn with these scores. ",
    element("code", {}, "gauntlet render"), " draws comparison.mp4 beside this page."),
    element("p", {class: "controls"}, element("button", {type: "button",
      onclick: () => place.replaceChildren(videoElement(curves))}, "Show comparison.mp4")));
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
function followAddress(curves) {
  const apply = () => {
    const asked = new URLSearchParams(location.hash.slice(1));
    const has = (select, value) => [...select.options].some((option) => option.value === value);
    if (has(curves.view, asked.get("view"))) curves.view.value = asked.get("view");
    if (has(curves.select, asked.get("channel"))) curves.select.value = asked.get("channel");
    else if (!asked.has("view") && !asked.has("t")) return;  // a part of the page
    curves.show();
    const time = Number.parseFloat(asked.get("t"));
    if (Number.isFinite(time)) {
      curves.showTime(time);
      curves.onTime?.(time);
    }
    byId("curves").scrollIntoView();
  };
  apply();
  window.addEventListener("hashchange", apply);
  curves.onView = (time) => {
    const view = new URLSearchParams({channel: curves.select.value, view: curves.view.value});
    if (time !== null) view.set("t", time.toFixed(3));
    history.replaceState(null, "", `#${view}`);
  };
}

function startCurves(data) {
  byId("curves-note").textContent = curvesNote(data);
  let spectra = null;
  const curves = new CurvesView(data, (name, channel) => {
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
  showProblems(data);
  let curves = null;
  const drawHeatMap = startHeatMap(data, (name) => {
    if (!curves) return;
    curves.selectChannel(name);
    byId("curves").scrollIntoView();
  });
  const drawTables = () => {
    if (data.error_split) drawErrorSplit(data);
    drawScoreTable(data);
    if (data.latency) drawLatency(data);
    drawHeatMap();
  };
  startOrder(data, drawTables);
  drawTables();
  if (data.error_split) startErrorSplit(data);
  else hidePart("error");
  if (!data.latency) hidePart("latency");
  if (!byId("recording")) document.querySelector('nav a[href="#recording"]').hidden = true;
  byId("scores-table").parentElement.after(saveButtons(data, "scores", null, () => scoreRows(data)));
  if (data.latency) {
    byId("latency-table").parentElement.after(saveButtons(data, "latency", null, () => latencyRows(data)));
  }
  startFrontChart(data);
  let drawSeeds = () => {};
  if (data.seeds.length > 1) drawSeeds = startSeeds(data);
  else hidePart("seeds");
  if (data.curves) {
    curves = startCurves(data);
  } else {
    hidePart("curves");
    hidePart("spectra");
  }
  const replay = startReplay(data, curves);
  startVideo(curves);
  if (curves) followAddress(curves);
  startSettings();
  followScreen(() => {
    if (data.error_split) drawErrorBars(data);
    drawSeeds();
    curves?.show();
    replay?.redraw();
  });
}

start();
