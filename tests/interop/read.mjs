// Reads MCAP files by Foxglove's own reader and prints what it found, a line of JSON a file.
import { open } from "node:fs/promises";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";
import { McapIndexedReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";

const SUMMED = ["time_s", "lat_rad", "altitude_m", "airspeed_mps", "throttle"];

async function read(path) {
  const file = await open(path, "r");
  const reader = await McapIndexedReader.Initialize({
    readable: new FileHandleReadable(file),
    decompressHandlers: await loadDecompressHandlers(),
  });
  const types = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    types.set(channel.id, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
  }
  const found = { counts: {}, sums: {}, metadata: {}, attachments: {}, first: null, last: null };
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const { topic } = reader.channelsById.get(message.channelId);
    const decoded = types.get(message.channelId).decode(message.data);
    found.counts[topic] = (found.counts[topic] ?? 0) + 1;
    found.first ??= String(message.logTime);
    found.last = String(message.logTime);
    if (topic === "/state") {
      for (const name of SUMMED) {
        found.sums[name] = (found.sums[name] ?? 0) + decoded[name];
      }
    } else if (topic === "/outcome") {
      found.outcome = decoded.outcome;
    }
  }
  for await (const record of reader.readMetadata()) {
    found.metadata[record.name] = Object.fromEntries(record.metadata);
  }
  for await (const record of reader.readAttachments()) {
    found.attachments[record.name] = record.data.byteLength;
  }
  found.compressions = [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))];
  await file.close();
  return found;
}

for (const path of process.argv.slice(2)) {
  console.log(JSON.stringify(await read(path)));
}
