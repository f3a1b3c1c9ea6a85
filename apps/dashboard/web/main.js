// SPDX-License-Identifier: Apache-2.0
// The stream of snapshots, and who shows what of it.
import { Charts } from "/charts.js";
import { showStatus, showLost } from "/status.js";
import { Tables } from "/tables.js";

const SILENCE_MS = 2000;
const TABLES_EVERY_MS = 500; // what a person reads

const charts = new Charts(document.getElementById("charts"));
const tables = new Tables();
let heardAt = performance.now();
let tablesAt = -Infinity;

function show(snapshot) {
  heardAt = performance.now();
  showStatus(snapshot);
  charts.add(snapshot);
  if (heardAt - tablesAt >= TABLES_EVERY_MS) {
    tablesAt = heardAt;
    tables.show(snapshot);
  }
}

async function acknowledge() {
  const answer = await fetch("/acknowledge", { method: "POST" });
  if (!answer.ok) showLost(`not acknowledged: ${answer.status}`);
}

const button = document.getElementById("acknowledge");
button.addEventListener("click", acknowledge);
document.addEventListener("keydown", (event) => {
  const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
  if (plain && event.key.toLowerCase() === "a" && !button.disabled) acknowledge();
});

// The stream brings what is new. The ten seconds before it are fetched once it runs, so that nothing falls between the
// two; also when the browser has connected again.
async function fetchWhole() {
  try {
    show(await (await fetch("/snapshot")).json());
  } catch {
    showLost("the dashboard does not answer");
  }
}

function begin() {
  const stream = new EventSource("/events");
  stream.onopen = fetchWhole;
  stream.onmessage = (event) => show(JSON.parse(event.data));
}

setInterval(() => {
  if (performance.now() - heardAt > SILENCE_MS) showLost("no word from the dashboard");
}, 500);
begin();
