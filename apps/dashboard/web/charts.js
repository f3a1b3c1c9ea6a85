// SPDX-License-Identifier: Apache-2.0
// The newest ten seconds of what moves.
import uPlot from "/uPlot.esm.js";

const KEPT_S = 10;
const HEIGHT = 122;
const STEP_TICKS = 20; // between two rows of the dashboard
const FIGURES = [
  { title: "Acceleration [m/s²]", series: [{ name: "accel_y_m_s2", key: "platform, right" }], least: 1 },
  { title: "Force of the hand [N]", series: [{ name: "force_n", key: "measured" }, { name: "predicted_force_n", key: "predicted by the model" }], least: 1 },
  { title: "Motor force [N]", series: [{ name: "motor_force_n", key: "on the stick" }], limits: true, least: 1 },
  { title: "Screen [m]", series: [{ name: "target_m", key: "target" }, { name: "cursor_m", key: "cursor" }], least: 0.05 },
];

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function caption(figure, limit) {
  const node = document.createElement("figcaption");
  const title = document.createElement("b");
  title.textContent = figure.title;
  node.append(title);
  figure.series.forEach(({ key }, i) => {
    const part = document.createElement("span");
    part.className = i === 0 ? "key" : "key second";
    part.textContent = key;
    node.append(part);
  });
  if (figure.limits) {
    const part = document.createElement("span");
    part.className = "key limit";
    part.textContent = `limits ±${limit} N`;
    node.append(part);
  }
  const note = document.createElement("span");
  note.className = "note";
  node.append(note);
  return { node, note };
}

class Chart {
  constructor(parent, figure, limit) {
    this.figure = figure;
    this.limit = limit;
    this.box = document.createElement("figure");
    this.plot = null;
    const { node, note } = caption(figure, limit);
    this.note = note;
    this.place = document.createElement("div");
    this.place.setAttribute("role", "img");
    this.place.setAttribute("aria-label", `${figure.title}, newest ${KEPT_S} seconds`);
    this.box.append(node, this.place);
    parent.append(this.box);
    new ResizeObserver(() => this.plot?.setSize({ width: this.place.clientWidth, height: HEIGHT })).observe(this.place);
  }

  // Anew whenever the colours change.
  draw(data) {
    this.plot?.destroy();
    const axis = { stroke: colour("--faint"), grid: { stroke: colour("--rule"), width: 1 }, ticks: { stroke: colour("--rule") }, font: "12px sans-serif" };
    const lines = this.figure.series.map((_, i) => ({ stroke: colour(`--line-${i + 1}`), width: 1.75, dash: i === 0 ? undefined : [6, 4], points: { show: false } }));
    if (this.figure.limits) {
      for (let i = 0; i < 2; ++i) lines.push({ stroke: colour("--limit"), width: 1.5, dash: [2, 4], points: { show: false } });
    }
    const least = this.figure.limits ? 1.1 * this.limit : this.figure.least;
    this.plot = new uPlot({
      width: Math.max(this.place.clientWidth, 100), height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: (_, min, max) => [Math.min(min, max - KEPT_S), max] },
        y: { range: (_, min, max) => {
          const most = Math.max(least, Math.abs(min ?? 0), Math.abs(max ?? 0));
          return [-1.05 * most, 1.05 * most];
        } } },
      axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((s) => `${s}`) }, { ...axis, size: 46 }],
      series: [{}, ...lines],
    }, data, this.place);
  }

  show(rows, hidden) {
    const data = [[], ...this.figure.series.map(() => []), ...(this.figure.limits ? [[], []] : [])];
    const add = (tick, values) => {
      data[0].push(tick / 1000);
      values.forEach((value, i) => data[i + 1].push(value));
      if (this.figure.limits) {
        data.at(-2).push(this.limit);
        data.at(-1).push(-this.limit);
      }
    };
    let last = null;
    for (const row of rows) {
      // Nothing is drawn where nothing was heard.
      if (last !== null && row.tick - last > 2 * STEP_TICKS) add(last + STEP_TICKS, this.figure.series.map(() => null));
      add(row.tick, this.figure.series.map(({ name }) => row[name]));
      last = row.tick;
    }
    const note = hidden && this.figure.limits ? "hidden while a person tracks (blinded)" : "";
    if (this.note.textContent !== note) this.note.textContent = note;
    if (this.plot) this.plot.setData(data); else this.draw(data);
  }
}

export class Charts {
  constructor(parent) {
    this.parent = parent;
    this.charts = [];
    this.rows = [];
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const chart of this.charts) { chart.plot?.destroy(); chart.plot = null; }
    });
  }

  add({ traces, limits, session }) {
    if (this.charts.length === 0) this.charts = FIGURES.map((figure) => new Chart(this.parent, figure, limits.motor_force_n));
    if (traces.tick.length === 0) return;
    const arrived = traces.tick.map((_, i) => Object.fromEntries(Object.keys(traces).map((name) => [name, traces[name][i]])));
    const newest = arrived.at(-1).tick;
    // Ticks that go far back are another session.
    if (newest < (this.rows.at(-1)?.tick ?? -1) - 1000 * KEPT_S) this.rows = [];
    if (arrived[0].tick > (this.rows.at(-1)?.tick ?? -1)) {
      this.rows.push(...arrived);
    } else {
      const byTick = new Map([...this.rows, ...arrived].map((row) => [row.tick, row]));
      this.rows = [...byTick.values()].sort((one, other) => one.tick - other.tick);
    }
    const oldest = this.rows.at(-1).tick - 1000 * KEPT_S;
    this.rows = this.rows.filter((row) => row.tick >= oldest);
    const hidden = session.blinded && session.phase === "tracking";
    for (const chart of this.charts) chart.show(this.rows, hidden);
  }
}
