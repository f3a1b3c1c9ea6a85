// SPDX-License-Identifier: Apache-2.0
// A replay on the page: the strip says so, whatever was wrong then, and no action is offered. The page's own scripts run
// here with a document of plain objects.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";

const WEB = new URL("../../../apps/dashboard/web/", import.meta.url);
const folder = mkdtempSync(join(tmpdir(), "stillhand-page-"));
for (const name of ["elements.js", "cost.js", "status.js", "actions.js"]) {
  const text = readFileSync(new URL(name, WEB), "utf8").replaceAll('from "/', 'from "./');
  writeFileSync(join(folder, name.replace(".js", ".mjs")), text.replaceAll('.js"', '.mjs"'));
}
const nodes = new Map();
const node = (id) => nodes.get(id) ?? nodes.set(id, { dataset: {}, textContent: "", addEventListener() {} }).get(id);
globalThis.document = { getElementById: node, querySelectorAll: () => [], addEventListener() {}, body: { dataset: {} } };
const { showStatus } = await import(join(folder, "status.mjs"));
const { Actions } = await import(join(folder, "actions.mjs"));
rmSync(folder, { recursive: true });

const snapshot = (session) => ({ mode: "live", domain: 7, rig: 1, now_ms: 5000, level_since_ms: 0, services: [], events: [],
  actions: { enabled: true }, session: { state: "running", emergency: true, emergency_ms: 1000, ...session },
  alarms: [{ watch: "missing", subject: "sensing", level: "critical", worst: 3000, since_ms: 1000, active: true, acknowledged: false, count: 1 }] });

test("a replay says REPLAY and not the emergency of then", () => {
  showStatus(snapshot({ replayed: true }));
  assert.equal(node("strip").dataset.level, "replay");
  assert.equal(node("word").textContent, "REPLAY");
  assert.match(node("what").textContent, /domain 7, rig 1.*at that time: emergency stop$/);
  assert.equal(node("acknowledge").hidden, true);
});

test("the strip of a recording names the file next to an alarm", () => {
  showStatus({ ...snapshot({ emergency: false }), mode: "recording", file: "session.mcap" });
  assert.equal(node("strip").dataset.past, true);
  assert.match(node("what").textContent, /sensing.*; recording session\.mcap$/);
});

test("a replay offers no action, and no emergency stop", () => {
  const sut = new Actions();
  sut.show(snapshot({ replayed: true }));
  assert.equal(node("emergency").hidden, true);
  assert.equal(node("actions-part").hidden, true);
});

test("a session of now keeps its emergency and its actions", () => {
  showStatus(snapshot({ replayed: false }));
  new Actions().show(snapshot({ replayed: false }));
  assert.equal(node("word").textContent, "Emergency stop");
  assert.equal(node("emergency").hidden, false);
  assert.equal(node("actions-part").hidden, false);
});
