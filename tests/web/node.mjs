// SPDX-License-Identifier: Apache-2.0
// node.mjs PACKAGE RECORDING TRAJECTORY CONFIG [LIMIT_M]: @odograph/web in node plays a recording with PNG pictures, and its poses are compared with the
// native command line's (trajectory.tum). Rejections have a reason; memory does not grow. 77 without the package or npm's pngjs.
import {createRequire} from 'node:module';
import fs from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {differences, endure, play, Player, quantile} from './play.mjs';

const [folder, recording, trajectory, config_file, limit_m = '0.1'] = process.argv.slice(2);
const skip = why => { console.log(`SKIPPED: ${why}`); process.exit(77); };
if (!fs.existsSync(path.join(folder, 'odograph.wasm'))) skip(`no ${folder}/odograph.wasm: packaging/targets wasm builds it`);
let PNG;
try {
  ({PNG} = createRequire(path.join(process.env.NODE_PATH?.split(':')[0] ?? '.', 'x.js'))('pngjs'));
} catch {
  skip("no npm package pngjs in NODE_PATH's first folder");
}
const {load, ODO_E_DATA, TYPES, OdographError} = await import(pathToFileURL(path.resolve(folder, 'index.js')));
const odograph = await load({wasm: fs.readFileSync(path.join(folder, 'odograph.wasm'))});
const failures = [], check = (good, what) => { if (!good) failures.push(what); };
const bytes = () => new Uint8Array(fs.readFileSync(recording)), config = fs.readFileSync(config_file, 'utf8');
const decode = async picture => {
  const {width, height, data} = PNG.sync.read(Buffer.from(picture));
  const pixels = new Uint8Array(width * height);
  for (let i = 0; i < pixels.length; ++i) pixels[i] = data[4 * i];
  return {width, height, pixels};
};

// Against the native command line.
const first = await play(odograph, TYPES, bytes(), config, decode);
const off = differences(first.poses, fs.readFileSync(trajectory, 'utf8'));
console.log(`${off.compared} poses; largest difference from the native command line ${(1e3 * off.metres).toFixed(3)} mm and ${off.degrees.toFixed(5)} degrees, ` +
  `beyond 1 um from pose ${off.first} on; ${first.statistics.distance_m.toFixed(2)} m walked`);
console.log(`a picture takes ${quantile(first.frames_ms, 0.5).toFixed(1)} ms (median), ${quantile(first.frames_ms, 0.99).toFixed(1)} ms (99 %); the longest push ${Math.max(...first.pushes_ms).toFixed(1)} ms`);
check(off.compared > 100, `${off.compared} poses compared`);
check(off.metres <= Number(limit_m), `${off.metres} m off; at most ${limit_m}`);

// Two parallel sessions are each bit-identical to a single one.
const pair = [1, 2].map(() => new Player(odograph, TYPES, bytes(), config));
for (let going = true; going;) going = (await Promise.all(pair.map(player => player.next(decode)))).some(Boolean);
pair.forEach(player => player.end());
for (const {poses} of pair)
  check(poses.length === first.poses.length && poses.every((pose, i) => pose.p_n.every((x, k) => x === first.poses[i].p_n[k])), 'two sessions at once: other poses than of one alone');

// Memory: repeating the same walk in one session causes no growth.
const frames = Number(process.env.ODOGRAPH_WEB_FRAMES ?? 600), {sizes, taken} = await endure(odograph, TYPES, bytes, config, decode, frames);
console.log(`memory ${(sizes[0] / 2 ** 20).toFixed(0)} MiB after the first walk, ${(sizes.at(-1) / 2 ** 20).toFixed(0)} MiB after ${taken} frames in one session`);
check(taken >= frames, `${taken} frames taken of ${frames}`);
check(sizes.at(-1) === sizes[0], 'memory grew');

// Rejections and their reasons.
const refused = (text, ...words) => {
  try {
    odograph.createSession({config: text}).close();
    failures.push(`was taken: ${text}`);
  } catch (error) {
    check(error instanceof OdographError && error.status < 0, `no OdographError: ${error}`);
    for (const word of words) check(error.message.includes(word), `'${error.message}' lacks '${word}'`);
  }
};
refused('odograph: 1\nattitude:\n  plugin: attitude/vqf\n  isolation: process\n', ':3:', 'isolation', "platform (none)", "'isolation: none'");
refused('odograph: 1\nattitude:\n  plugin: attitude/magyq\n', 'attitude/magyq', 'not linked into this program', 'attitude/vqf');
refused('odograph: 1\nattitude:\n  plugin: attitude/vqf\n  gain: 3\n', 'gain');
refused('odograph: 1\ncamera: camera.yaml\nattitude:\n  plugin: attitude/vqf\n', 'camera.yaml');
try {
  odograph.openRecording(new TextEncoder().encode('no recording at all'));
  failures.push('what is no recording was opened');
} catch (error) {
  check(error instanceof OdographError, `no OdographError: ${error}`);
}
// Maps: the package has no plugin that makes one.
const session = odograph.createSession({config});
check(session.saveMap().length === 0, 'a map without fix/map');
try {
  session.loadMap(new TextEncoder().encode('no map at all'));
  failures.push('what is no map was loaded');
} catch (error) {
  check(error instanceof OdographError && error.status === ODO_E_DATA, `no OdographError of damaged data: ${error}`);
}
session.close();

// The page's interpolation of a browser's sparse samples: parabolas at even times, nothing across a gap.
const {Between} = await import('../../samples/web/live.js');
const between = new Between(), parabola = t => [t * t, 1 - 3 * t, 2 * t * t - t], times = [0, 15, 30, 45, 60, 500, 516, 532, 548, 564].map(ms => ms / 1e3);
const filled = times.flatMap(t => between.add({t_ns: t * 1e9, gyro: parabola(t), accel: parabola(t + 1)}));
const amiss = Math.max(...filled.flatMap(({t_ns, gyro, accel}) => [...gyro.map((v, i) => v - parabola(t_ns / 1e9)[i]), ...accel.map((v, i) => v - parabola(t_ns / 1e9 + 1)[i])].map(Math.abs)));
check(filled.length === 17 && amiss < 1e-12, `between samples: ${filled.length}, ${amiss} off`);
check(filled.every(({t_ns}, i) => !i || t_ns > filled[i - 1].t_ns) && !filled.some(({t_ns}) => t_ns > 60e6 && t_ns < 500e6), 'between samples: not in order, or across a gap');
failures.forEach(text => console.log('FAILED:', text));
process.exit(failures.length ? 1 : 0);
