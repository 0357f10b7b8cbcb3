// SPDX-License-Identifier: Apache-2.0
// page_script.js PAGE_FOLDER: the computations of a run's page, against values computed by hand.
'use strict';
const assert = require('assert'), fs = require('fs'), path = require('path'), vm = require('vm');
const page = vm.createContext({});
for (const part of ['charts', 'map', 'picture', 'scene']) vm.runInContext(fs.readFileSync(path.join(process.argv[2], part + '.js'), 'utf8'), page);
const call = text => vm.runInContext(text, page);
const near = (seen, wanted, what) => wanted.forEach((x, k) => assert(Math.abs(seen[k] - x) < 1e-9, `${what}: ${seen}, expected ${wanted}`));

assert.deepStrictEqual([-1, 0, 0, 2].map((_, k) => call(`before([1, 2, 3], ${[0.5, 1, 1.9, 9][k]})`)), [-1, 0, 0, 2]);
assert.strictEqual(call('tick(10, 5)'), 2);
assert.strictEqual(call('readable(0.05)'), '0.050');
// A quarter turn about down maps north to east; then twice the size and a shift.
near(call('lay({laid: {q: [Math.SQRT1_2, 0, 0, Math.SQRT1_2], p: [10, 20, 30], s: 2}}, [1, 0, 5], 0)'), [10, 22, 40], 'lay');
near(call('rotate([Math.SQRT1_2, 0, 0, Math.SQRT1_2], [1, 0, 0])'), [0, 1, 0], 'rotate');
near(call('rotate([Math.SQRT1_2, 0, 0, Math.SQRT1_2], [0, 1, 0], true)'), [1, 0, 0], 'rotate back');
const lens = more => `Object.assign({model: 'pinhole', fx: 500, fy: 400, cx: 320, cy: 240, distortion: []}, ${more})`;
near(call(`project(${lens('{}')}, [1, 0.5, 2])`), [570, 340], 'pinhole');
// x = 0.5, y = 0.25, r^2 = 0.3125; radial 1.0322265625 (OpenCV's k1 k2 p1 p2).
near(call(`project(${lens('{distortion: [0.1, 0.01, 0.02, 0.03]}')}, [1, 0.5, 2])`), [320 + 500 * 0.54548828125, 240 + 400 * 0.274306640625], 'distorted');
near(call(`project(${lens("{model: 'equidistant'}")}, [1, 0, 1])`), [320 + 500 * Math.PI / 4, 240], 'fisheye without distortion');
assert.strictEqual(call(`project(${lens('{}')}, [0, 0, -1])`), null);
near([call('area([0, 0, 0, 2, 0, 0, 2, 0, 3, 0, 0, 3])')], [6], 'area of a wall');
near([call('heightOf({placed: [0, 0, -1.4]}, {laid: [0, 0, 0.1, 1, 0, 0.1, 0, 1, -0.2]})')], [1.4 * -1 - 0], 'height');
// Tilted, what is ahead is farther away; from above, what is below.
assert(call('map.tilt = 1.5, depth([9, 0, 0], 0) > depth([1, 0, 0], 0)'));
assert(call('map.tilt = 0, depth([0, 0, 3], 0) > depth([0, 0, 1], 0)'));
console.log('the page computes what it should');
