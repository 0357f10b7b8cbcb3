// SPDX-License-Identifier: Apache-2.0
// mcap_file.js FILE: reads MCAP by @mcap/core, by its index and as a stream; Foxglove's messages have the fields of
// @foxglove/schemas. 77 without those packages.
'use strict';
const fs = require('fs');
let mcap, schemas;
try {
  mcap = require('@mcap/core');
  schemas = require('@foxglove/schemas/jsonschema');
} catch (e) {
  process.exit(77);
}

/** The mismatch of a value with its schema; empty if there is none. */
function fault(value, schema, at) {
  const kind = Array.isArray(value) ? 'array' : Number.isInteger(value) && schema.type === 'integer' ? 'integer' : typeof value;
  if (schema.type && kind !== schema.type) return `${at}: ${kind} where ${schema.type} is expected`;
  if (kind === 'array') return schema.items ? value.map((v, k) => fault(v, schema.items, `${at}/${k}`)).find(Boolean) : '';
  if (kind !== 'object') return '';
  const unknown = Object.keys(value).find(key => !(schema.properties || {})[key]);
  return unknown ? `${at}/${unknown}: not in the schema` : Object.entries(value).map(([k, v]) => fault(v, schema.properties[k], `${at}/${k}`)).find(Boolean) || '';
}

(async () => {
  const bytes = fs.readFileSync(process.argv[2]);
  const readable = {size: async () => BigInt(bytes.length), read: async (at, n) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(at), Number(n))};
  const reader = await mcap.McapIndexedReader.Initialize({readable});
  const counts = {}, faults = new Set();
  for await (const m of reader.readMessages()) {
    const channel = reader.channelsById.get(m.channelId), schema = reader.schemasById.get(channel.schemaId);
    const value = JSON.parse(Buffer.from(m.data).toString());
    counts[channel.topic] = (counts[channel.topic] || 0) + 1;
    const own = JSON.parse(Buffer.from(schema.data).toString());
    const foxglove = schema.name.startsWith('foxglove.') ? schemas[schema.name.slice(9)] || {type: 'no such schema'} : own;
    for (const one of [own, foxglove]) if (fault(value, one, channel.topic)) faults.add(fault(value, one, channel.topic));
  }
  const stream = new mcap.McapStreamReader({validateCrcs: true});
  stream.append(bytes);
  while (stream.nextRecord());
  console.log('@mcap/core:', JSON.stringify(counts));
  for (const text of faults) console.log('FAILED:', text);
  if (!stream.done()) console.log('FAILED: the stream has no end');
  for (const topic of ['/camera', '/pose', '/track', '/tf', '/imu', '/state', '/camera/calibration'])
    if (!counts[topic]) { faults.add(topic); console.log('FAILED: nothing on', topic); }
  process.exit(faults.size || !stream.done() ? 1 : 0);
})();
