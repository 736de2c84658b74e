// Jitter against delay is drawn into the page, once for each of three widths. This saves the one that is shown.

function startFrontChart(data) {
  const figure = () => [...byId("front-chart").querySelectorAll("svg")].find((svg) => svg.getBoundingClientRect().width > 0);
  if (!figure()) return;
  const column = (key) => data.metrics.findIndex((metric) => metric.key === key);
  const [delay, jitter] = [column("delay_ms"), column("jitter_rms_deg")];
  byId("front-chart").after(saveButtons(data, "front", figure, () => [
    ["controller", "delay_ms", "jitter_rms_deg"],
    ...data.controllers.map((c) => [c.name, c.summary[delay][0], c.summary[jitter][0]])
      .filter((row) => row[1] !== null && row[2] !== null)]));
}
