// SPDX-License-Identifier: Apache-2.0
// Usage: node read_recording.mjs FILE
// Reads FILE twice with the MCAP project's own TypeScript reader, by index and as a stream with
// every checksum validated, and prints one JSON object.  Exits with 1 when either refuses the file
// or when the two differ.
import { readFileSync } from "node:fs";
import { createHash } from "node:crypto";
import { crc32 } from "node:zlib";
import { McapIndexedReader } from "@mcap/core";
import { decompressHandlers, streamOf } from "./recording.mjs";

function newTally() {
  return { topics: {}, channels: {}, schemas: {}, metadata: {}, messages: 0, hash: createHash("sha256") };
}

function count(tally, channel, message) {
  const topic = (tally.topics[channel.topic] ??= { messages: 0 });
  topic.messages += 1;
  const entry = (tally.channels[channel.id] ??= { topic: channel.topic, messages: 0 });
  entry.encoding = channel.messageEncoding;
  entry.schema = channel.schemaId;
  entry.metadata = Object.fromEntries(channel.metadata);
  entry.messages += 1;
  tally.messages += 1;
  tally.hash.update(`${channel.topic} ${message.sequence} ${message.logTime} ${message.publishTime} `);
  tally.hash.update(message.data);
}

function keepSchema(tally, schema) {
  tally.schemas[schema.id] = {
    name: schema.name,
    encoding: schema.encoding,
    text: new TextDecoder().decode(schema.data),
  };
}

async function byIndex(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => {
      if (offset + length > BigInt(bytes.length)) throw new Error("read beyond the end");
      return new Uint8Array(bytes.subarray(Number(offset), Number(offset + length)));
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const tally = newTally();
  for (const schema of reader.schemasById.values()) keepSchema(tally, schema);
  for await (const record of reader.readMetadata()) {
    tally.metadata[record.name] = Object.fromEntries(record.metadata);
  }
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    count(tally, reader.channelsById.get(message.channelId), message);
  }
  return { tally, reader };
}

function byStream(bytes) {
  const tally = newTally();
  const channels = new Map();
  for (const record of streamOf(bytes)) {
    if (record.type === "Schema") keepSchema(tally, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") count(tally, channels.get(record.channelId), record);
    if (record.type === "Metadata") {
      tally.metadata[record.name] = Object.fromEntries(record.metadata);
    }
  }
  return tally;
}

const bytes = new Uint8Array(readFileSync(process.argv[2]));
const { tally: indexed, reader } = await byIndex(bytes);
const streamed = byStream(bytes);
const statistics = reader.statistics;
const report = {
  profile: reader.header.profile,
  library: reader.header.library,
  messages: indexed.messages,
  topics: indexed.topics,
  channels: indexed.channels,
  schemas: indexed.schemas,
  metadata: indexed.metadata,
  chunks: reader.chunkIndexes.length,
  compression: [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))],
  statistics: {
    messages: Number(statistics.messageCount),
    schemas: statistics.schemaCount,
    channels: statistics.channelCount,
    chunks: statistics.chunkCount,
    metadata: statistics.metadataCount,
    start_ns: String(statistics.messageStartTime),
    end_ns: String(statistics.messageEndTime),
  },
  data_crc_in_file: reader.dataSectionCrc,
};
// The reader does not check this one; the data section ends 9 + 4 bytes before the summary.
if (crc32 !== undefined && reader.dataSectionCrc !== undefined) {
  const end = Number(reader.footer.summaryStart) - 13;
  report.data_crc_computed = crc32(bytes.subarray(0, end));
}
report.sha256 = streamed.hash.copy().digest("hex");
const text = JSON.stringify(report, null, 1);
console.log(text);
const same =
  JSON.stringify([indexed.topics, indexed.channels, indexed.schemas, indexed.metadata]) ===
  JSON.stringify([streamed.topics, streamed.channels, streamed.schemas, streamed.metadata]);
if (!same || indexed.messages !== report.statistics.messages) {
  console.error("index and stream differ, or the statistics are wrong");
  process.exit(1);
}
