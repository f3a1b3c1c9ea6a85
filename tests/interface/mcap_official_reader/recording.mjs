// SPDX-License-Identifier: Apache-2.0
// What both scripts need of the MCAP project's reader.
import { createRequire } from "node:module";
import { McapStreamReader } from "@mcap/core";
import { decompress as unzstd } from "fzstd";

const lz4 = createRequire(import.meta.url)("lz4js");

export const decompressHandlers = {
  zstd: (packed, size) => unzstd(packed, new Uint8Array(Number(size))),
  lz4: (packed) => new Uint8Array(lz4.decompress(packed)),
};

// Every record in the order of the file, each checksum validated.
export function* streamOf(bytes) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()) !== undefined; ) yield record;
  if (!reader.done()) throw new Error("stream reader wants more bytes");
}
