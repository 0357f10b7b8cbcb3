// SPDX-License-Identifier: Apache-2.0
//
// Writes and reads every message with WebAssembly's layout, and compares with the native programs: exchange.js FOLDER
'use strict';
const fs = require('fs');
const {execFileSync} = require('child_process');
const folder = process.argv[2];
const ages = ['old', 'new'];

function program(age) {
  const {exports} = new WebAssembly.Instance(new WebAssembly.Module(fs.readFileSync(`${folder}/${age}.wasm`)));
  exports.memory.grow(4);
  const at = Math.ceil(exports.__heap_base.value / 16) * 16;
  const types = new Uint32Array(exports.memory.buffer, exports.odo_types.value);
  return {
    write: () => Buffer.from(new Uint8Array(exports.memory.buffer, at, exports.odo_write(at))),
    read(bytes, grown) {
      new Uint8Array(exports.memory.buffer).set(bytes, at);
      const digests = [];
      for (let i = 0; types[i]; ++i) digests.push(String(BigInt.asUintN(64, exports.odo_read(at, bytes.length, types[i], grown))));
      return digests;
    },
  };
}

let held = 0;
let messages = 0;
const wasm = {old: program('old'), new: program('new')};
for (const writer of ages) {
  const file = `${folder}/${writer}.messages`;
  execFileSync(`${folder}/${writer}.native`, ['write', file]);
  for (const [where, bytes] of [['here', fs.readFileSync(file)], ['WebAssembly', wasm[writer].write()]]) {
    fs.writeFileSync(file, bytes);
    for (const reader of ages) {
      for (const grown of [0, 1]) {
        const native = execFileSync(`${folder}/${reader}.native`, ['read', file, String(grown)], {encoding: 'utf8'}).trim().split('\n');
        const other = wasm[reader].read(bytes, grown);
        // Without the later version's fields all readers read the same.
        const expected = grown ? native : execFileSync(`${folder}/old.native`, ['read', `${folder}/reference`, '0'], {encoding: 'utf8', input: ''}).trim().split('\n');
        messages = native.length;
        other.forEach((digest, i) => {
          if (digest !== native[i] || native[i] !== expected[i] || BigInt(digest) === 0n) {
            console.error(`message ${i}: written by the ${writer} version on ${where}, read by the ${reader} one: ` +
                          `${native[i]} here, ${digest} on WebAssembly, expected ${expected[i]}`);
            process.exit(1);
          }
          held += 1;
        });
      }
    }
  }
}
console.log(`${held} combinations hold: ${messages} messages, 2 writers on 2 layouts, 2 readers on 2 layouts, with and without what was added`);
