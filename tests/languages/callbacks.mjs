// SPDX-License-Identifier: Apache-2.0
// What onEvent throws comes out of push once, and events go on; it cannot close the session. A map of an
// earlier session, which is the argument, is saved as it was.
import assert from 'node:assert';
import {readFileSync} from 'node:fs';
import {load, OdographError} from '@odograph/node';

const odograph = load();
let seen = 0;
const thrown = [];
const session = odograph.createSession({config: 'odograph: 1\nattitude: {plugin: attitude/vqf}\n', onEvent: () => {
  seen += 1;
  if (seen === 20) throw new RangeError('once');
  if (seen === 200) session.close();
}});
for (let i = 0; i < 400; ++i) {
  try {
    session.pushImu(1000000000n + BigInt(i) * 5000000n, [0.1, 0, 0.02], [0.1, 0.2, 9.8]);
  } catch (error) {
    thrown.push(error.message);
  }
}
session.close();
assert(seen > 300);
assert.strictEqual(thrown.length, 2);
assert.strictEqual(thrown[0], 'once');
assert(thrown[1].includes('onEvent'));

const later = odograph.createSession({config: 'odograph: 1\nattitude: {plugin: attitude/vqf}\nabsolute_fixers: {plugin: fix/map}\n'});
const map = new Uint8Array(readFileSync(process.argv[2]));
assert.strictEqual(later.saveMap().length, 0);
assert.throws(() => later.loadMap(Uint8Array.of(1, 2, 3)), OdographError);
later.loadMap(map);
assert.deepStrictEqual(later.saveMap(), map);
later.close();
