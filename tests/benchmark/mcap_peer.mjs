// SPDX-License-Identifier: Apache-2.0
// Usage: node mcap_peer.mjs FILE MESSAGES BYTES TOPICS REPEATS
// Writes and reads a recording with the MCAP project's own library (@mcap/core), uncompressed, in
// chunks of 256 KiB.  Prints the processor time of each repeat [s] as JSON.  For recorder_peers.py.
import { closeSync, openSync, readFileSync, writeSync } from "node:fs";
import { McapIndexedReader, McapWriter } from "@mcap/core";

const [file, ...numbers] = process.argv.slice(2);
const [messages, bytes, topics, repeats] = numbers.map(Number);

class Sink {
  constructor(path) {
    this.descriptor = openSync(path, "w");
    this.size = 0n;
  }
  async write(part) {
    writeSync(this.descriptor, part);
    this.size += BigInt(part.byteLength);
  }
  position() {
    return this.size;
  }
}

async function write() {
  const sink = new Sink(file);
  const writer = new McapWriter({ writable: sink, chunkSize: 256 * 1024 });
  await writer.start({ profile: "", library: "peer" });
  const channels = [];
  for (let i = 0; i < topics; ++i) {
    channels.push(await writer.registerChannel({
      topic: `load/${i}`, schemaId: 0, messageEncoding: "cdr", metadata: new Map(),
    }));
  }
  const data = new Uint8Array(bytes);
  for (let n = 0; n < messages; ++n) {
    const time = BigInt(n) * 1000000n;
    await writer.addMessage({ channelId: channels[n % topics], sequence: n, logTime: time, publishTime: time, data });
  }
  await writer.end();
  closeSync(sink.descriptor);
}

async function read() {
  const all = readFileSync(file);
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(all.length),
      read: async (offset, length) => new Uint8Array(all.subarray(Number(offset), Number(offset + length))),
    },
  });
  let seen = 0;
  for await (const message of reader.readMessages()) seen += message.data.length;
  if (seen !== messages * bytes) throw new Error("messages are missing");
}

async function seconds(work) {
  const spent = [];
  for (let i = 0; i < repeats; ++i) {
    const begin = process.cpuUsage();
    await work();
    const { user, system } = process.cpuUsage(begin);
    spent.push((user + system) * 1e-6);
  }
  return spent;
}

console.log(JSON.stringify({ write_s: await seconds(write), read_s: await seconds(read) }));
