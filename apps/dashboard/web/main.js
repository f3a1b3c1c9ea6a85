// SPDX-License-Identifier: Apache-2.0
// Passes each snapshot to the modules that show it.
import { Actions } from "/actions.js";
import { Charts } from "/charts.js";
import { element } from "/elements.js";
import { Graph } from "/graph.js";
import { TrackingScreen } from "/screen.js";
import { Sound } from "/sound.js";
import { Spectrum } from "/spectrum.js";
import { showLost, showStatus, withMismatches } from "/status.js";
import { Stream } from "/stream.js";
import { Tables } from "/tables.js";
import { Timeline } from "/timeline.js";

const TABLES_EVERY_MS = 500; // tables are for reading, not for watching

const actions = new Actions();
const charts = new Charts(element("charts"));
const graph = new Graph();
const screen = new TrackingScreen();
const sound = new Sound();
const spectrum = new Spectrum(element("spectrum"));
const tables = new Tables();
let tablesAt = -Infinity;

function show(snapshot, whole) {
  const past = snapshot.mode === "recording";
  snapshot.alarms = withMismatches(snapshot);
  element("timeline-part").hidden = !past;
  if (past) snapshot.recent = timeline.recent();
  showStatus(snapshot);
  actions.show(snapshot);
  sound.hear(snapshot);
  charts.add(snapshot, past);
  screen.show(snapshot, charts.rows, past);
  spectrum.show(snapshot.spectrum);
  graph.show(snapshot);
  if (whole || performance.now() - tablesAt >= TABLES_EVERY_MS) {
    tablesAt = performance.now();
    tables.show(snapshot);
  }
}

// One request at a time; of those that wait, only the newest is sent.
let asking = false;
let wanted = null;
async function fetchSnapshot(target) {
  wanted = target;
  if (asking) return;
  asking = true;
  try {
    while (wanted !== null) {
      const next = wanted;
      wanted = null;
      const snapshot = await (await fetch(next)).json();
      // The first snapshot only shows that this is a recording; its time line then asks for an instant.
      if (snapshot.mode === "recording" && next === "/snapshot") await timeline.begin();
      else show(snapshot, true);
    }
  } catch {
    // The stream shows the lost connection.
  } finally {
    asking = false;
  }
}

const timeline = new Timeline((seconds) => fetchSnapshot(`/snapshot?at=${seconds.toFixed(6)}`));

// The stream brings new rows. The ten seconds before are fetched once it runs, so that no row is missed between the two;
// also after the browser has connected again.
new Stream({
  opened: () => fetchSnapshot("/snapshot"),
  heard: (snapshot) => {
    if (snapshot.mode === "live") show(snapshot, false);
    else if ("stale" in document.body.dataset) timeline.begin();
  },
  lost: showLost,
});
