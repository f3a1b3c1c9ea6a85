// SPDX-License-Identifier: Apache-2.0
// Usage: node compare_values.mjs FILE TABLES
// Decodes every message of FILE with the MCAP project's reader and Foxglove's IDL parser and
// deserialiser, by the schema that FILE carries, and compares every value with the tables that
// `stillhand export FILE --csv TABLES` made.  Exits with 1 at the first topic that differs.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import { streamOf } from "./recording.mjs";

// RFC 4180: rows of cells.
function* csvRows(text) {
  let cells = [];
  for (let at = 0; at < text.length; ) {
    let cell = "";
    if (text[at] === '"') {
      for (at += 1; text[at] !== '"' || text[at + 1] === '"'; at += 1) {
        if (text[at] === '"') at += 1;
        cell += text[at];
      }
      at += 1;
    } else {
      const begin = at;
      while (at < text.length && text[at] !== "," && text[at] !== "\n") at += 1;
      cell = text.slice(begin, at);
    }
    cells.push(cell);
    if (text[at] === "\n") {
      yield cells;
      cells = [];
    }
    at += 1;
  }
}

// One topic's table, read row by row beside its messages.
class Table {
  constructor(folder, topic) {
    const name = topic.replaceAll(/[^A-Za-z0-9_]/g, "_");
    this.rows = csvRows(readFileSync(join(folder, `${name}.csv`), "utf8"));
    this.paths = this.rows.next().value.map((title) => title.replace(/ \[[^\]]*\]$/, "").split("."));
    this.count = 0;
  }
  next() {
    this.count += 1;
    return this.rows.next().value;
  }
}

// Constants of every enum, as "NAME=value".
function enumeratorsOf(definitions) {
  const names = new Set();
  for (const definition of definitions) {
    for (const field of definition.definitions ?? []) {
      if (field.isConstant) names.add(`${field.name}=${field.value}`);
    }
  }
  return names;
}

function same(cell, value) {
  if (value === undefined) return cell === "";
  if (typeof value === "string") return cell === value;
  if (typeof value === "boolean") return cell === (value ? "1" : "0");
  if (typeof value === "bigint") return cell !== "" && BigInt(cell) === value;
  return cell !== "" && (Object.is(Number(cell), value) || (cell === "nan" && Number.isNaN(value)));
}

// The value that a column's path leads to; undefined behind the end of a list.
function valueAt(message, path) {
  let value = message;
  for (const step of path) value = value === undefined ? undefined : value[step];
  return value;
}

function differs(topic, row, message, record) {
  const [, logTime, publishTime, sequence] = row;
  if (BigInt(logTime) !== record.logTime || BigInt(publishTime) !== record.publishTime ||
      Number(sequence) !== record.sequence) {
    return "times or sequence";
  }
  for (let i = 4; i < topic.table.paths.length; i += 1) {
    const path = topic.table.paths[i];
    const last = path.at(-1);
    const outer = path.slice(0, -1);
    let fits;
    if (last === "count" && valueAt(message, path) === undefined) {
      const list = valueAt(message, outer);
      fits = row[i] === (list === undefined ? "" : String(list.length));
    } else if (last === "name" && typeof valueAt(message, outer) === "number") {
      fits = topic.enumerators.has(`${row[i]}=${valueAt(message, outer)}`);
    } else {
      fits = same(row[i], valueAt(message, path));
    }
    if (!fits) return `${path.join(".")}: table "${row[i]}", message ${valueAt(message, path)}`;
  }
  return undefined;
}

const [file, tables] = process.argv.slice(2);
const schemas = new Map();
const channels = new Map();
const tablesOf = new Map(); // by topic: the channels of its writers share one
let values = 0;
for (const record of streamOf(new Uint8Array(readFileSync(file)))) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel" && !channels.has(record.id)) {
    const schema = schemas.get(record.schemaId);
    const definitions = parseIDL(new TextDecoder().decode(schema.data));
    if (!tablesOf.has(record.topic)) tablesOf.set(record.topic, new Table(tables, record.topic));
    channels.set(record.id, {
      name: record.topic,
      reader: new MessageReader(schema.name, definitions),
      enumerators: enumeratorsOf(definitions),
      table: tablesOf.get(record.topic),
    });
  }
  if (record.type !== "Message") continue;
  const topic = channels.get(record.channelId);
  const row = topic.table.next();
  const difference = row === undefined ? "no such row"
                                       : differs(topic, row, topic.reader.readMessage(record.data), record);
  if (difference !== undefined) {
    console.error(`${topic.name}, message ${topic.table.count}: ${difference}`);
    process.exit(1);
  }
  values += row.length;
}
let messages = 0;
for (const [name, table] of tablesOf) {
  if (table.next() !== undefined) {
    console.error(`${name}: the table has more rows than the recording messages`);
    process.exit(1);
  }
  messages += table.count - 1;
}
console.log(JSON.stringify({ topics: tablesOf.size, messages, values }));
