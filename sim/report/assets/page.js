// Puts the page together.

function showProblems(data) {
  const list = byId("problems");
  list.append(...data.failures.map((failure) => element("li", {}, failure)));
  for (const controller of data.controllers) {
    if (controller.untrusted_samples > 0) {
      list.append(element("li", {}, `${controller.name}: ${controller.untrusted_samples} glove ` +
        "samples were missing or out of range and replaced by the last good value"));
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
  for (const line of block ? block[1].trim().split("\n") : []) {
    const [key, ...rest] = line.trim().split(":");
    if (key.startsWith("#")) continue;
    place.append(element("dt", {}, key.replaceAll("_", " ")),
      element("dd", {}, rest.join(":").replace(/\s+#.*$/, "").trim().replace(/^["']|["']$/g, "")));
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
  const details = document.querySelector("#settings details");
  let was_open = false;
  window.addEventListener("beforeprint", () => {
    was_open = details.open;
    details.open = true;
    document.documentElement.dataset.paper = "";
    // Paper is light. What is light already stays: a canvas drawn now may miss the print.
    if (dark.matches) redraw();
  });
  window.addEventListener("afterprint", () => {
    details.open = was_open;
    delete document.documentElement.dataset.paper;
    if (dark.matches) redraw();
  });
}

function hidePart(id) {
  byId(id).hidden = true;
  document.querySelector(`nav a[href="#${id}"]`).hidden = true;
}

function start() {
  const data = JSON.parse(byId("data").textContent);
  showProblems(data);
  if (data.error_split) drawErrorSplit(data);
  else hidePart("error");
  drawScoreTable(data);
  drawFrontChart(data);
  if (data.latency) drawLatency(data);
  else hidePart("latency");
  let curves = null;
  startHeatMap(data, (name) => {
    if (!curves) return;
    curves.selectChannel(name);
    byId("curves").scrollIntoView();
  });
  if (data.curves) {
    byId("curves-note").textContent = curvesNote(data);
    curves = new CurvesView(data, markChannel);
  } else {
    hidePart("curves");
  }
  startVideo(curves);
  startSettings();
  followScreen(() => {
    if (data.error_split) drawErrorBars(data);
    drawFrontChart(data);
    curves?.show();
  });
}

start();
