// SPDX-License-Identifier: Apache-2.0
// Where the graph's nodes stand, which of its edges are at fault, and what lateness costs: scripts of the page that only
// compute.
import assert from "node:assert/strict";
import test from "node:test";
import { costInWords, costOf, costOfAlarm } from "../../../apps/dashboard/web/cost.js";
import { faultsOf, gone } from "../../../apps/dashboard/web/graph_faults.js";
import { layOut } from "../../../apps/dashboard/web/graph_layout.js";

const ALL = ["motion", "rig", "sensing", "cancellation", "display", "human_operator", "identification", "recorder", "experiment"];
const topic = (name, writers, readers) => ({ topic: name, writers, readers: readers.map((service) => ({ service })) });
const TOPICS = [
  topic("platform_command", ["motion"], ["rig", "recorder"]),
  topic("raw_sample", ["rig"], ["sensing", "recorder"]),
  topic("rig_truth", ["rig"], ["recorder"]),
  topic("sensed", ["sensing"], ["motion", "cancellation", "display", "identification", "recorder"]),
  topic("motor_command", ["cancellation"], ["rig", "recorder"]),
  topic("tracking_sample", ["display"], ["human_operator", "recorder"]),
  topic("operator_force", ["human_operator"], ["rig", "recorder"]),
  topic("pointer", ["display"], ["human_operator", "recorder"]),
  topic("feedthrough_model", ["identification"], ["cancellation", "experiment", "recorder"]),
  topic("answer", ["display"], ["experiment", "recorder"]),
  topic("trial_control", ["experiment"], ALL.filter((name) => name !== "experiment")),
  topic("event", ALL, ["experiment", "recorder"]),
  topic("session_command", ["dashboard"], ["rig", "experiment"])];

const NOW = 1_000_000;
const reader = (service, more = {}) => ({ service, matched: 1, samples: 100, lost_ticks: 0, cycle_misses: 0, deadline_misses: 0,
  worst_interval_us: 1500, latency_p99_us: 100, late: { first_ms: null, last_ms: null }, missed: { first_ms: null, last_ms: null }, lost: { first_ms: null, last_ms: null }, ...more });
const snapshot = (readers, more = {}) => ({ now_ms: NOW, session: { state: "running" }, services: [],
  graph: { topics: [{ topic: "sensed", writers: ["sensing"], readers }], qos_mismatches: [] }, ...more });

test("columns follow the chain from the rig round to itself", () => {
  const { nodes, columns } = layOut(TOPICS, ALL);
  const column = (name, again) => nodes.find((node) => node.name === name && Boolean(node.again) === Boolean(again)).column;
  assert.deepEqual(["rig", "raw_sample", "sensing", "sensed", "cancellation", "motor_command", "human_operator", "operator_force"].map((name) => column(name)),
    [0, 1, 2, 3, 4, 5, 6, 7]);
  assert.equal(column("rig", true), 8);
  assert.equal(columns, 9);
});

test("no two nodes lie on each other", () => {
  const { nodes } = layOut(TOPICS, ALL);
  const places = nodes.map(({ column, row }) => `${column} ${row}`);
  assert.equal(new Set(places).size, places.length, places.join(", "));
});

test("every edge of the chain is drawn once, and the rest stands aside", () => {
  const { edges, nodes, aside } = layOut(TOPICS, ALL);
  const names = edges.map(({ from, to }) => `${from}>${to}`);
  assert.equal(new Set(names).size, names.length);
  for (const wanted of ["rig>raw_sample", "sensed>motion", "identification>feedthrough_model", "feedthrough_model>cancellation", "operator_force>rig"]) {
    assert.ok(names.includes(wanted), wanted);
  }
  assert.deepEqual(aside, ["answer", "trial_control", "event", "session_command"]);
  for (const { from, to } of edges) {
    for (const name of [from, to]) assert.ok(nodes.some((node) => node.name === name), name);
  }
});

test("who writes to a neighbour of its column stands beside it", () => {
  const { nodes } = layOut(TOPICS, ALL);
  const row = (name) => nodes.find((node) => node.name === name).row;
  assert.equal(row("identification") - row("cancellation"), 1);
  assert.equal(row("human_operator"), row("display"));
});

test("an edge is late now for five seconds after its count grew, then it was", () => {
  const late = (last_ms) => faultsOf(snapshot([reader("motion", { cycle_misses: 1, late: { first_ms: 5000, last_ms } })]));
  const [now] = late(NOW - 4999);
  assert.deepEqual([now.kind, now.active, now.writer, now.reader, now.since_ms], ["late", true, "sensing", "motion", 5000]);
  assert.equal(now.text, "1 cycle late, longest interval 1.5 ms");
  assert.equal(late(NOW - 5001)[0].active, false);
  assert.deepEqual(faultsOf(snapshot([reader("motion")])), []);
});

test("what DDS counts as missed and what is lost is a warning, what only comes late is none", () => {
  const found = faultsOf(snapshot([reader("motion", { cycle_misses: 1, deadline_misses: 2, lost_ticks: 3, late: { first_ms: 1, last_ms: NOW },
    missed: { first_ms: 1, last_ms: NOW }, lost: { first_ms: 1, last_ms: NOW - 6000 } })]));
  assert.deepEqual(found.map(({ kind, level, active }) => [kind, level, active]), [["missed", "warning", true], ["late", "healthy", true], ["lost", "warning", false]]);
});

test("what both ends do not match is one edge, and a cut-off name is none", () => {
  const services = [{ service: "sensing", waits_for: "motion (sensed), rig (se" }, { service: "motion", waits_for: "sensing (sensed)" }];
  const found = faultsOf(snapshot([reader("motion")], { services }));
  assert.deepEqual(found.map(({ kind, writer, topic: name, reader: to }) => [kind, writer, name, to]), [["unmatched", "sensing", "sensed", "motion"]]);
  assert.deepEqual(faultsOf(snapshot([reader("motion")], { services, session: { state: "ending" } })), []);
});

test("a QoS mismatch is named by its policy, before everything else", () => {
  const wanted = snapshot([reader("motion", { lost_ticks: 3, lost: { first_ms: 1, last_ms: NOW } })]);
  wanted.graph.qos_mismatches.push({ service: "motion", topic: "sensed", policy: "RELIABILITY", since_ms: 7 });
  const found = faultsOf(wanted);
  assert.deepEqual(found.map(({ kind, level }) => [kind, level]), [["qos", "critical"], ["lost", "warning"]]);
  assert.equal(found[0].text, "QoS mismatch: RELIABILITY");
  assert.equal(found[0].since_ms, 7);
});

test("a process without a life sign for longer than its lease is gone", () => {
  assert.ok(gone({ service: "rig" }));
  assert.ok(gone({ service: "rig", state: "running", silent_ms: 301 }));
  assert.ok(!gone({ service: "rig", state: "running", silent_ms: 299 }));
});

const COST = { why: "", trial: 3, length_s: 12.6, left_n: 1.24, lateness_n: 0.081, limits_n: -0.02, sensor_n: -0.001, rest_n: 1.158,
  late_n: { sensing: 0.08, cancellation: 0.001, rig: 0, interlock: 0 } };

test("the cost stands at the process that kept the motor waiting, and nowhere else", () => {
  assert.equal(costOf(COST, "sensing"), "cost so far: 0.08 N");
  for (const process of ["cancellation", "rig", "display"]) assert.equal(costOf(COST, process), "");
  const alarm = { watch: "silent", subject: "stillhand/sensed", writer: "sensing" };
  assert.equal(costOfAlarm(COST, alarm), "cost so far: 0.08 N");
  assert.equal(costOfAlarm(COST, { watch: "missing", subject: "sensing", writer: "" }), "cost so far: 0.08 N");
  assert.equal(costOfAlarm(COST, { ...alarm, watch: "latency" }), "");
  assert.equal(costOfAlarm({ why: "no trial yet" }, alarm), "");
});

test("the cost in words says how much of what, from whom, or why nothing can be said", () => {
  assert.equal(costInWords(COST).join(""), "Cost of lateness so far: 0.08 N of the 1.24 N that trial 3 leaves after 13 s, from sensing 0.08 N. " +
    "Not from lateness: 1.16 N from model and body, −0.02 N from limits, 0.00 N from the sensor.");
  assert.match(costInWords({ ...COST, why: "no trial yet" }).join(""), /trial 3 left \(now: no trial yet\)/);
  assert.equal(costInWords({ why: "no trial yet" }).join(""), "Cost of lateness in newtons: no trial yet.");
});
