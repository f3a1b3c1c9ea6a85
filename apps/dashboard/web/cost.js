// SPDX-License-Identifier: Apache-2.0
// What lateness costs the motor's force, in words. Pure.
const newtons = (value) => `${value.toFixed(2).replace(/^-(?=0\.00$)/, "").replace("-", "−")} N`;
const LATE = ["late", "lost", "silent"];

// "cost so far: 0.08 N", of a process that keeps the motor waiting; empty where it has cost nothing that two digits show.
export function costOf(cost, process) {
  const force = cost?.late_n?.[process] ?? 0;
  return Math.abs(force) < 0.005 ? "" : `${cost.why === "" ? "cost so far" : `cost in trial ${cost.trial}`}: ${newtons(force)}`;
}

// The same of an alarm, if it is of an answer that did not come in time.
export function costOfAlarm(cost, { watch, subject, writer }) {
  return watch === "missing" ? costOf(cost, subject) : LATE.includes(watch) ? costOf(cost, writer) : "";
}

// Its beginning, and the rest of the sentence.
export function costInWords(cost) {
  if (cost.left_n === undefined) return ["Cost of lateness", ` in newtons: ${cost.why}.`];
  const { trial, length_s: length, left_n: left, lateness_n: late, limits_n: limits, sensor_n: sensor, rest_n: rest, late_n: each, why } = cost;
  const names = Object.entries(each).filter(([, force]) => Math.abs(force) >= 0.005).map(([name, force]) => `${name} ${newtons(force)}`);
  const from = names.length > 0 ? `, from ${names.join(", ")}` : "";
  const when = why === "" ? `trial ${trial} leaves after ${length.toFixed(0)} s` : `trial ${trial} left (now: ${why})`;
  return [`Cost of lateness${why === "" ? " so far" : ""}: ${newtons(late)}`,
    ` of the ${newtons(left)} that ${when}${from}. Not from lateness: ${newtons(rest)} from model and body, ${newtons(limits)} from limits, ${newtons(sensor)} from the sensor.`];
}
