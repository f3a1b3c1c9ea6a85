// SPDX-License-Identifier: Apache-2.0
// Usage: node read_ros2.mjs BAG.mcap
// Reads a bag with Foxglove's parser of ROS 2 definitions and its deserialiser; prints for each topic
// the type, how many messages, every 1000th of them with its log time, and the last bytes left over.
import { readFileSync } from "node:fs";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompressHandlers } from "./recording.mjs";

const bytes = readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const readers = new Map();
const topics = {};
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(schema.id)) {
    readers.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  }
  const topic = (topics[channel.topic] ??= { type: schema.name, encoding: schema.encoding, messages: 0, samples: [] });
  const value = readers.get(schema.id).readMessage(message.data);
  if (topic.messages % 1000 === 0) topic.samples.push({ log_time: String(message.logTime), value });
  topic.messages += 1;
}
const plain = (_key, value) => (typeof value === "bigint" ? String(value)
  : ArrayBuffer.isView(value) ? Array.from(value) : value);
console.log(JSON.stringify({ profile: reader.header.profile, topics }, plain));
