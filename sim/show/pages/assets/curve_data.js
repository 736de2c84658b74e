// Curves as sim/show/pages/curve_codec.h writes them, and what of them a screen of some width needs.

function decodeCurve(text, step) {
  const bytes = atob(text);
  const values = new Float64Array(bytes.length);
  let count = 0;
  let last = 0;
  for (let i = 0; i < bytes.length; ++count) {
    let number = 0;
    let scale = 1;
    let byte = 128;
    while (byte >= 128) {
      byte = bytes.charCodeAt(i++);
      number += (byte & 127) * scale;
      scale *= 128;
    }
    if (number === 0) {
      values[count] = NaN;
      continue;
    }
    const doubled = number - 1;
    last += doubled % 2 ? -(doubled + 1) / 2 : doubled / 2;
    values[count] = last * step;
  }
  return values.subarray(0, count);
}

// Decoded curves of the channels looked at last: one channel takes some megabytes.
class CurveStore {
  constructor(data) {
    this.curves = data.curves;
    this.controllers = data.controllers.length;
    this.kept = new Map();
    const bucket = this.curves.samples_per_bucket;
    this.bucketed = bucket > 1;
    this.points = this.bucketed ? 2 * Math.ceil(this.curves.samples / bucket) : this.curves.samples;
    this.step_s = (this.bucketed ? bucket / 2 : 1) / data.rate_hz;
    this.first_s = this.bucketed ? this.step_s / 2 : 0;
    this.duration_s = this.curves.samples / data.rate_hz;
  }

  time(point) { return this.first_s + point * this.step_s; }

  pointAt(time_s) {
    return Math.min(this.points - 1, Math.max(0, Math.round((time_s - this.first_s) / this.step_s)));
  }

  // {true, raw, controllers: [{hand, filtered, command}]}, each an array of degrees.
  channel(index) {
    if (!this.kept.has(index)) {
      if (this.kept.size >= 3) this.kept.delete(this.kept.keys().next().value);
      const {step_deg, channels} = this.curves;
      const decode = (text) => decodeCurve(text, step_deg);
      this.kept.set(index, {
        true: decode(channels[index].true),
        raw: decode(channels[index].raw),
        controllers: channels[index].controllers.map((c) => ({
          hand: decode(c.hand), filtered: decode(c.filtered), command: decode(c.command)})),
      });
    }
    return this.kept.get(index);
  }
}

// Smallest and largest of values[from, to), in the order of time; [NaN, NaN] of nothing.
function extremes(values, from, to) {
  let low = -1;
  let high = -1;
  for (let i = from; i < Math.min(to, values.length); ++i) {
    if (Number.isNaN(values[i])) continue;
    if (low < 0 || values[i] < values[low]) low = i;
    if (high < 0 || values[i] > values[high]) high = i;
  }
  if (low < 0) return [NaN, NaN];
  return [values[Math.min(low, high)], values[Math.max(low, high)]];
}

// Rows for the plot: fine inside [from_s, to_s], coarse outside of it (the overview needs that),
// never losing a peak. `columns` are arrays of the store's points.
function plotRows(store, columns, from_s, to_s, pixels) {
  const rows = [];
  const append = (from, to, buckets) => {
    const size = (to - from) / Math.max(1, buckets);
    if (size <= 2) {
      for (let i = from; i < to; ++i) {
        rows.push([store.time(i), ...columns.map((c) => (i < c.length ? c[i] : NaN))]);
      }
      return;
    }
    for (let b = 0; b < buckets; ++b) {
      const begin = from + Math.floor(b * size);
      const end = from + Math.floor((b + 1) * size);
      const pairs = columns.map((c) => extremes(c, begin, end));
      rows.push([store.time(begin + (end - begin) * 0.25), ...pairs.map((p) => p[0])],
        [store.time(begin + (end - begin) * 0.75), ...pairs.map((p) => p[1])]);
    }
  };
  // A little more than is seen, so that lines reach the edges.
  const begin = Math.max(0, store.pointAt(from_s) - 4);
  const end = Math.min(store.points, store.pointAt(to_s) + 5);
  const coarse = (count) => Math.round(pixels * 0.5 * count / store.points);
  append(0, begin, coarse(begin));
  append(begin, end, pixels);
  append(end, store.points, coarse(store.points - end));
  return rows;
}
