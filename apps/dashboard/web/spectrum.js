// SPDX-License-Identifier: Apache-2.0
// Power density of the measured force and of the residual (METHOD, Eq. DB-6).
import uPlot from "/uPlot.esm.js";
import { axisOf, colour, figureOf } from "/charts.js";
import { mark, write } from "/elements.js";

const HEIGHT = 210;
const MARKED_HZ = [0.25, 0.5, 1, 2, 5, 10, 20, 50];
const DECADES = 6; // shown below the largest

function decades(min, max) {
  const first = Math.ceil(Math.log10(min) - 1e-9);
  const count = Math.max(0, Math.floor(Math.log10(max) + 1e-9) - first + 1);
  const step = count > 7 ? 2 : 1;
  return Array.from({ length: Math.ceil(count / step) }, (_, i) => 10 ** (first + step * i));
}

const positive = (values) => values.map((value) => Math.max(value, 1e-12));

function rangeOf(min, max) {
  const top = Math.ceil(Math.log10(max));
  return [10 ** Math.max(Math.floor(Math.log10(min)), top - DECADES), 10 ** top];
}

export class Spectrum {
  constructor(parent) {
    this.parent = parent;
    this.plot = null;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.plot?.destroy(); this.plot = null; this.drawn(); });
  }

  // undefined: unchanged; null: no spectrum
  show(spectrum) {
    if (spectrum === undefined) return;
    if (!this.place) {
      const keys = [{ key: "force measured", look: "" }, { key: "residual", look: "second" }];
      Object.assign(this, figureOf(this.parent, "Power density [N²/Hz] over frequency [Hz]", keys, "Spectrum"));
      new ResizeObserver(() => this.plot?.setSize({ width: this.place.clientWidth, height: HEIGHT })).observe(this.place);
    }
    this.spectrum = spectrum;
    this.drawn();
  }

  drawn() {
    const { spectrum } = this;
    if (!this.place) return;
    if (!spectrum) {
      write(this.note, "shown after 4.1 s of force and prediction without a gap");
      mark(this.place, "aria-label", "Spectrum: not enough samples yet");
      this.plot?.destroy();
      this.plot = null;
      return;
    }
    const [force, residual] = [spectrum.force_rms_n, spectrum.residual_rms_n];
    const bridged = spectrum.bridged_ticks > 0 ? `, ${spectrum.bridged_ticks} lost ticks bridged` : "";
    const summary = `RMS 0.2 to 50 Hz: force ${force.toFixed(2)} N, residual ${residual.toFixed(2)} N`;
    write(this.note, `${summary} (newest ${spectrum.length_s.toFixed(1)} s, ${spectrum.segments} segments${bridged})`);
    const peak = spectrum.frequency_hz[spectrum.residual_n2_hz.indexOf(Math.max(...spectrum.residual_n2_hz))];
    mark(this.place, "aria-label", `Spectrum of force and residual up to 50 Hz. ${summary}; the residual is largest at ${peak.toFixed(2)} Hz`);
    const columns = [spectrum.frequency_hz, positive(spectrum.force_n2_hz), positive(spectrum.residual_n2_hz)];
    if (this.plot) this.plot.setData(columns); else this.draw(columns);
  }

  draw(columns) {
    const line = (i, dash) => ({ stroke: colour(`--line-${i}`), width: 1.75, dash, points: { show: false } });
    this.plot = new uPlot({
      width: Math.max(this.place.clientWidth, 100), height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, distr: 3, range: () => [MARKED_HZ[0], MARKED_HZ.at(-1)] }, y: { distr: 3, range: (_, min, max) => rangeOf(min, max) } },
      axes: [axisOf({ size: 28, splits: () => MARKED_HZ, filter: (_, splits) => splits, values: (_, ticks) => ticks.map((hz) => `${hz}`) }),
        axisOf({ size: 56, splits: (_, axis, min, max) => decades(min, max), filter: (_, splits) => splits, values: (_, ticks) => ticks.map((value) => (value === null ? "" : value >= 1000 || value < 0.01 ? `10^${Math.round(Math.log10(value))}`.replace(/\^(-?)(\d+)/, (__, minus, digits) => (minus ? "⁻" : "") + [...digits].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]).join("")) : `${value}`)) })],
      series: [{}, line(1), line(2, [6, 4])],
    }, columns, this.place);
  }
}
