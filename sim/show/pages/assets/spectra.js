// What the first seed tells by frequency, of the channel of the curves: how the hand trembles, and what
// the whole chain from wearer to hand does to slow and fast motion. Welch's method: the mean over
// stretches that overlap by half, each times a Hann window (Welch 1967). Only stretches that the scores
// count as a whole: what stands in a gap of a recording is made up.

const SPECTRUM_HZ = [3, 60];     // where the jitter is: below, the motion itself is larger than any tremble
const RESPONSE_HZ = [0.3, 12];
const SPECTRUM_WINDOW_S = 1.1;   // at most
const RESPONSE_WINDOW_S = 2.1;
const SPECTRUM_WINDOWS = 1;      // at least
const RESPONSE_WINDOWS = 2;      // of one alone the coherence is 1
const LEAST_COHERENCE = 0.8;     // below it the hand does something else than follow
const FIGURE_HEIGHT = 250;

// In place, of a power of two: the textbook's radix 2.
function fourier(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; ++i) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [re[i], re[j]] = [re[j], re[i]];
      [im[i], im[j]] = [im[j], im[i]];
    }
  }
  for (let size = 2; size <= n; size *= 2) {
    const half = size / 2;
    for (let k = 0; k < half; ++k) {
      const c = Math.cos(-2 * Math.PI * k / size);
      const s = Math.sin(-2 * Math.PI * k / size);
      for (let i = k; i < n; i += size) {
        const j = i + half;
        const tr = re[j] * c - im[j] * s;
        const ti = re[j] * s + im[j] * c;
        re[j] = re[i] - tr; im[j] = im[i] - ti;
        re[i] += tr; im[i] += ti;
      }
    }
  }
}

function withoutTrend(values) {
  const n = values.length;
  const middle = (n - 1) / 2;
  let mean = 0;
  let slope = 0;
  for (let i = 0; i < n; ++i) { mean += values[i] / n; slope += values[i] * (i - middle); }
  slope /= n * (n * n - 1) / 12;
  return values.map((value, i) => value - mean - slope * (i - middle));
}

// What the scores count of `samples`, as [begin, end) each, where `uncounted_s` has what they don't.
function countedRanges(uncounted_s, samples, rate_hz) {
  const ranges = [];
  let begin = 0;
  for (const [from, to] of [...uncounted_s, [samples / rate_hz, Infinity]]) {
    const end = Math.round(from * rate_hz);
    if (end > begin) ranges.push([begin, end]);
    begin = Math.round(to * rate_hz);
  }
  return ranges;
}

function windowSize(samples, rate_hz, longest_s) {
  let size = 2;
  while (2 * size <= Math.min(samples, longest_s * rate_hz)) size *= 2;
  return size;
}

// Where windows of `size` begin that overlap by half, each within one range.
function windowBegins(ranges, size) {
  return ranges.flatMap(([from, to]) =>
    Array.from({length: Math.max(0, Math.floor(2 * (to - from) / size) - 1)}, (_, i) => from + i * size / 2));
}

// Sums over stretches of |X|^2, |Y|^2 and conj(X) Y, per frequency; `scale` makes |X|^2 a density.
function crossSpectra(x, y, ranges, rate_hz, longest_s) {
  const size = windowSize(x.length, rate_hz, longest_s);
  const window = Float64Array.from({length: size}, (_, i) => Math.sin(Math.PI * (i + 0.5) / size) ** 2);
  const power = window.reduce((sum, w) => sum + w * w, 0);
  const bins = size / 2;
  const sums = {xx: new Float64Array(bins), yy: new Float64Array(bins), re: new Float64Array(bins), im: new Float64Array(bins)};
  let stretches = 0;
  const transform = (values) => {
    const re = Float64Array.from(withoutTrend(values), (value, i) => value * window[i]);
    const im = new Float64Array(size);
    fourier(re, im);
    return {re, im};
  };
  for (const begin of windowBegins(ranges, size)) {
    const a = x.subarray(begin, begin + size);
    const b = y.subarray(begin, begin + size);
    if (a.some(Number.isNaN) || b.some(Number.isNaN)) continue;
    const X = transform(a);
    const Y = transform(b);
    ++stretches;
    for (let k = 0; k < bins; ++k) {
      sums.xx[k] += X.re[k] ** 2 + X.im[k] ** 2;
      sums.yy[k] += Y.re[k] ** 2 + Y.im[k] ** 2;
      sums.re[k] += X.re[k] * Y.re[k] + X.im[k] * Y.im[k];
      sums.im[k] += X.re[k] * Y.im[k] - X.im[k] * Y.re[k];
    }
  }
  return {...sums, stretches, step_hz: rate_hz / size, scale: 2 / (stretches * rate_hz * power)};
}

// Per controller [[Hz, deg/sqrt(Hz)]..]: the amplitude density of the hand's angle.
function jitterSpectrum(channel, ranges, rate_hz) {
  return channel.controllers.map(({hand}) => {
    const {yy, scale, step_hz} = crossSpectra(hand, hand, ranges, rate_hz, SPECTRUM_WINDOW_S);
    return [...yy].map((power, k) => [k * step_hz, Math.sqrt(power * scale)])
      .filter(([f]) => f >= SPECTRUM_HZ[0] && f <= SPECTRUM_HZ[1]);
  });
}

// Per controller [[Hz, gain, phase in deg, coherence]..] of hand against wearer. Without gain and phase
// where the hand does not follow.
function response(channel, ranges, rate_hz) {
  return channel.controllers.map(({hand}) => {
    const {xx, yy, re, im, step_hz, stretches} = crossSpectra(channel.true, hand, ranges, rate_hz, RESPONSE_WINDOW_S);
    let last = 0;
    return [...xx].map((power, k) => {
      const cross = Math.hypot(re[k], im[k]);
      const coherence = cross * cross / (power * yy[k]);
      let phase = Math.atan2(im[k], re[k]) * 180 / Math.PI;
      phase -= 360 * Math.round((phase - last) / 360);  // no jump by a turn
      const follows = stretches >= RESPONSE_WINDOWS && coherence >= LEAST_COHERENCE;
      if (follows) last = phase;
      return [k * step_hz, follows ? cross / power : NaN, follows ? phase : NaN, coherence];
    }).filter(([f]) => f >= RESPONSE_HZ[0] && f <= RESPONSE_HZ[1]);
  });
}

class SpectraView {
  constructor(data, store) {
    this.data = data;
    this.store = store;
    byId("spectra-legend").append(...controllersLegend(data));
    const names = data.controllers.map((c) => c.name);
    const table = (first, curves, value) => () => [["frequency_hz", ...names.map((name) => `${name}_${first}`)],
      ...curves()[0].map((row, i) => [row[0], ...curves().map((curve) => curve[i][value])])];
    byId("spectrum-chart").after(saveButtons(data, "spectrum", () => this.spectrum(),
      table("deg_per_sqrt_hz", () => this.jitter, 1)));
    byId("gain-chart").after(saveButtons(data, "gain", () => this.gain(), table("gain", () => this.response, 1)));
    byId("phase-chart").after(saveButtons(data, "phase", () => this.phase(), table("phase_deg", () => this.response, 2)));
  }

  show(channel) {
    this.channel = channel;
    const curves = this.store.channel(channel);
    const {rate_hz} = this.data;
    this.ranges = countedRanges(this.data.uncounted_s?.[channel] ?? [], curves.true.length, rate_hz);
    this.jitter = jitterSpectrum(curves, this.ranges, rate_hz);
    this.response = response(curves, this.ranges, rate_hz);
    byId("spectrum-chart").replaceChildren(this.spectrum());
    byId("gain-chart").replaceChildren(this.gain());
    byId("phase-chart").replaceChildren(this.phase());
  }

  // Or one sentence, where too little counts for it.
  figure(curves, value, x, y, what, longest_s, windows) {
    const width = Math.max(300, byId("spectrum-chart").clientWidth);
    const {rate_hz} = this.data;
    const size = windowSize(this.store.points, rate_hz, longest_s);
    if (windowBegins(this.ranges, size).length < windows) {
      const number = windows === 1 ? "no window" : `fewer than ${windows} windows`;
      return element("svg", {class: "figure", viewBox: `0 0 ${width} 40`, height: 40, role: "img",
        "aria-label": `${what}: not known`},
        element("text", {x: 0, y: 24}, `Not known: ${number} of ${formatNumber(size / rate_hz)} s in what counts.`));
    }
    return lineFigure({width, height: FIGURE_HEIGHT, x, y,
      label: `${what} of ${this.data.channels[this.channel]}, a line per controller`,
      lines: this.data.order.map((c) => ({colour: colourName(c), points: curves[c].map((row) => [row[0], row[value]])}))});
  }

  spectrum() {
    const values = this.jitter.flatMap((curve) => curve.map((row) => row[1])).filter((v) => v > 0);
    const high = Math.max(...values, 1e-6);
    return this.figure(this.jitter, 1, {label: "frequency, Hz", low: SPECTRUM_HZ[0], high: SPECTRUM_HZ[1], log: true},
      {label: "deg/√Hz", low: Math.max(Math.min(...values, high / 2), high * 1e-4), high, log: true}, "Spectrum of the hand",
      SPECTRUM_WINDOW_S, SPECTRUM_WINDOWS);
  }

  gain() {
    const values = this.response.flatMap((curve) => curve.map((row) => row[1])).filter(Number.isFinite);
    return this.figure(this.response, 1, {label: "frequency, Hz", low: RESPONSE_HZ[0], high: RESPONSE_HZ[1], log: true},
      {label: "gain", low: 0, high: Math.max(1.2, 1.1 * Math.max(...values, 0))}, "Gain from wearer to hand",
      RESPONSE_WINDOW_S, RESPONSE_WINDOWS);
  }

  phase() {
    const values = this.response.flatMap((curve) => curve.map((row) => row[2])).filter(Number.isFinite);
    return this.figure(this.response, 2, {label: "frequency, Hz", low: RESPONSE_HZ[0], high: RESPONSE_HZ[1], log: true},
      {label: "phase, deg", low: Math.min(-90, 1.05 * Math.min(...values, 0)), high: Math.max(0, ...values)}, "Phase from wearer to hand",
      RESPONSE_WINDOW_S, RESPONSE_WINDOWS);
  }
}
