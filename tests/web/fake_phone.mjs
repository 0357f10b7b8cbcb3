// SPDX-License-Identifier: Apache-2.0
// A phone that walks like a recording: the page's camera is a stream of the recording's pictures, its motion events are the recording's inertial samples, both with the recording's times.
// The samples are decimated to the rate of browsers, about 60 per second.
import {load} from './odograph/index.js';

const RATE_HZ = 66;
const TRUE_POSE = 0x10000;
const SECONDS_OF_TRUTH = 1e-9;

const rotate = ([w, x, y, z], [a, b, c]) => {
  const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * t[0] + y * t[2] - z * t[1], b + w * t[1] + z * t[0] - x * t[2], c + w * t[2] + x * t[1] - y * t[0]];
};
const conjugate = ([w, x, y, z]) => [w, -x, -y, -z];

/** Positions of the true path, read from the file's records, which the library skips. */
function truePath(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset), path = [];
  for (let at = 16; at + 16 <= bytes.length;) {
    const type = view.getUint32(at + 4, true), size = view.getUint32(at + 8, true);
    if (type === TRUE_POSE) path.push({t_s: Number(view.getBigInt64(at + 16, true)) * SECONDS_OF_TRUTH, p: [0, 1, 2].map(i => view.getFloat64(at + 16 + 40 + 8 * i, true))});
    at += 16 + size;
  }
  return path;
}

export async function fakePhone(url) {
  const bytes = new Uint8Array(await (await fetch(url)).arrayBuffer()), path = truePath(bytes.slice());
  const odograph = await load(), recording = odograph.openRecording(bytes);
  const messages = [];
  for (let message; (message = recording.next());) messages.push(message);
  const calibration = messages.find(({type}) => type === 'calibration'), first_frame = messages.find(({type}) => type === 'frame');
  const canvas = Object.assign(document.createElement('canvas'), {width: calibration.width, height: calibration.height}), context = canvas.getContext('2d');
  const stream = canvas.captureStream(0);
  navigator.mediaDevices.getUserMedia = async wanted => {
    if (!wanted.video) throw new DOMException('no microphone', 'NotFoundError');
    setTimeout(() => stream.getVideoTracks()[0].requestFrame(), 50);
    return stream;
  };
  // Pictures come at the recording's times, independent of this machine's drawing speed.
  let callback = null;
  HTMLVideoElement.prototype.play = async () => {};
  HTMLVideoElement.prototype.requestVideoFrameCallback = function (wanted) { callback = wanted; return 1; };
  const makeBitmap = window.createImageBitmap.bind(window);
  let taken = Promise.resolve();
  window.createImageBitmap = source => (taken = makeBitmap(source instanceof HTMLVideoElement ? canvas : source));

  // From the recording's body to the body of a phone with its top to the left, whose rear camera is the recording's.
  const SENSOR = [0, Math.SQRT1_2, -Math.SQRT1_2, 0];
  const turn = v => rotate(SENSOR, rotate(conjugate(calibration.q_b_c), v));
  const samples_ns = messages.filter(({type}) => type === 'imu').map(({t_ns}) => Number(t_ns));
  const every = Math.max(1, Math.round((samples_ns.length - 1) / (samples_ns.at(-1) - samples_ns[0]) * 1e9 / RATE_HZ));
  const line_ns = Number(first_frame.line_time_ns || calibration.line_time_ns);

  return {
    facts: () => ({angle_deg: 2 * Math.atan(calibration.width / 2 / calibration.fx) * 180 / Math.PI, readout_ms: line_ns * calibration.height / 1e6}),
    async walk() {
      const told = [];
      addEventListener('odograph-picture', ({detail: {pose, metric, placed}}) => { if (metric && placed) told.push({t_s: Number(pose.t_ns) * SECONDS_OF_TRUTH, distance_m: pose.distance_m}); });
      let samples = 0, pictures = 0, seen = 0, first_s = Infinity, last_s = -Infinity;
      const DEGREES = 180 / Math.PI;
      for (const message of messages) {
        if (message.type === 'imu' && seen++ % every === 0) {
          const gyro = turn(message.gyro_b), accel = turn(message.accel_b), event = new DeviceMotionEvent('devicemotion', {interval: 1000 / 60,
            accelerationIncludingGravity: {x: accel[0], y: accel[1], z: accel[2]}, rotationRate: {alpha: gyro[0] * DEGREES, beta: gyro[1] * DEGREES, gamma: gyro[2] * DEGREES}});
          Object.defineProperty(event, 'timeStamp', {value: Number(message.t_ns) / 1e6});
          window.dispatchEvent(event);
          ++samples;
          first_s = Math.min(first_s, Number(message.t_ns) / 1e9), last_s = Number(message.t_ns) / 1e9;
        } else if (message.type === 'frame') {
          const bitmap = await makeBitmap(new Blob([message.picture]));
          context.drawImage(bitmap, 0, 0);
          const t_ms = Number(message.t_ns) / 1e6;
          const call = callback;
          callback = null;
          call?.(t_ms, {captureTime: t_ms});
          ++pictures;
          await taken; // a phone has time
          await new Promise(done => setTimeout(done, 25));
        }
      }
      for (let before = -1; before !== told.length;) { // until the last one
        before = told.length;
        await new Promise(done => setTimeout(done, 2000));
      }
      // From the first metric pose to the last one.
      const first = told[0], last = told.at(-1);
      let path_m = 0;
      for (let i = 1; i < path.length; ++i)
        if (path[i - 1].t_s > first?.t_s - 0.01 && path[i].t_s < last.t_s + 0.01) path_m += Math.hypot(...path[i].p.map((x, k) => x - path[i - 1].p[k]));
      return {samples, pictures, told: told.length, rate_hz: samples / (last_s - first_s), path_m, distance_m: last ? last.distance_m - first.distance_m : NaN};
    },
  };
}
