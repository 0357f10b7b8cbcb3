// SPDX-License-Identifier: Apache-2.0
// A phone's camera and motion sensors in a browser. Times are those of performance.now(), in ns; axes are Android's: x
// right, y up, z out of the screen of the phone held upright.
import {cross, dot, length, multiply, scale, subtract} from './math.js';

const DEGREE = Math.PI / 180;
const CAPTURE_TO_NOW_MS = 60; // assumed: from the middle of the exposure to the callback, if the browser does not report the time of capture

/** Asks for the motion sensors; on iOS call it within a touch. Throws an error with a message for the user. */
export async function requestMotion() {
  if (!window.isSecureContext) throw new Error('Camera and motion sensors need a page by https (or of this machine itself).');
  if (typeof DeviceMotionEvent === 'undefined') throw new Error('This browser has no motion sensors. Open the page on a phone.');
  if (typeof DeviceMotionEvent.requestPermission !== 'function') return;
  const answer = await DeviceMotionEvent.requestPermission();
  if (answer !== 'granted') throw new Error('The motion sensors were refused. On an iPhone: close this page, open it again, and allow “Motion & Orientation Access”.');
}

/** The rear camera's stream. Throws an error with a message for the user. */
export async function requestCamera() {
  if (!navigator.mediaDevices?.getUserMedia) throw new Error('This browser does not give pages access to a camera.');
  try {
    return await navigator.mediaDevices.getUserMedia({audio: false, video: {facingMode: {ideal: 'environment'}, width: {ideal: 640}, height: {ideal: 480}, frameRate: {ideal: 30}}});
  } catch (error) {
    if (error.name === 'NotAllowedError') throw new Error('The camera was refused. Allow it for this page in the browser’s settings, and try again.');
    if (error.name === 'NotFoundError' || error.name === 'OverconstrainedError') throw new Error('No camera was found.');
    if (error.name === 'NotReadableError') throw new Error('Another app is using the camera. Close it, and try again.');
    throw error;
  }
}

/** iOS inverts the acceleration with gravity: at rest it points down, while the standard requires up. */
const gravityIsReversed = () => navigator.vendor.startsWith('Apple'); // all browsers of iOS are WebKit

/** Assignment of rotationRate's numbers to axes: browsers use alpha, beta, gamma as x, y, z; older versions of the
 * standard z, x, y. Gravity, which rotates with the phone, decides: the order whose prediction fits better so far. */
export class AxisOrder {
  #last = null; #errors = [0, 0]; #turned = 0;
  static ORDERS = [r => [r.alpha, r.beta, r.gamma], r => [r.beta, r.gamma, r.alpha]];
  order = 0;

  see(t_s, accel, rate) {
    const last = this.#last;
    this.#last = {t_s, accel};
    if (!last || t_s - last.t_s > 0.1 || t_s <= last.t_s) return;
    const change = scale(subtract(accel, last.accel), 1 / (t_s - last.t_s));
    AxisOrder.ORDERS.forEach((pick, i) => {
      const off = subtract(change, scale(cross(scale(pick(rate), DEGREE), accel), -1));
      this.#errors[i] = 0.998 * this.#errors[i] + dot(off, off);
    });
    this.#turned += length(AxisOrder.ORDERS[0](rate)) * DEGREE * (t_s - last.t_s);
    if (this.#turned > 1 && this.#errors[1 - this.order] < 0.6 * this.#errors[this.order]) this.order = 1 - this.order;
  }
  pick(rate) { return AxisOrder.ORDERS[this.order](rate); }
}

const WANTED_MS = 5, LONGEST_MS = 100; // intervals between samples: wanted, for piecewise linear integration; longest that is interpolated

/** Browsers give about 60 samples a second. Linear interpolation cuts off the peaks of a step: it made ten walks 1.1 %
 * too short on average, these curves 0.1 % too long (docs/web.md). Cubics with the slopes of Catmull & Rom 1974; a
 * sample is emitted when the next one has arrived. */
export class Between {
  #last = []; // three at most; the newest is not emitted yet

  /** Returns the samples {t_ns, gyro, accel} that become available with `sample`. */
  add(sample) {
    const newest = this.#last.at(-1), far = newest && sample.t_ns - newest.t_ns > LONGEST_MS * 1e6;
    const given = !newest ? [] : this.#last.length === 3 && !far ? [...Between.#curve(...this.#last, sample), newest] : [newest];
    this.#last = far ? [sample] : [...this.#last.slice(-2), sample];
    return given;
  }

  /** The curve between b and c. */
  static #curve(a, b, c, d) {
    const dt_ns = c.t_ns - b.t_ns, count = Math.round(dt_ns / (WANTED_MS * 1e6));
    const at = (f, field) => b[field].map((_, i) => {
      const [v0, v1, v2, v3] = [a, b, c, d].map(sample => sample[field][i]);
      const rise1 = (v2 - v0) * dt_ns / (c.t_ns - a.t_ns), rise2 = (v3 - v1) * dt_ns / (d.t_ns - b.t_ns), more = v2 - v1;
      return v1 + f * (rise1 + f * (3 * more - 2 * rise1 - rise2 + f * (rise1 + rise2 - 2 * more)));
    });
    return Array.from({length: Math.max(count - 1, 0)}, (_, k) => (k + 1) / count).map(f => ({t_ns: b.t_ns + f * dt_ns, gyro: at(f, 'gyro'), accel: at(f, 'accel')}));
  }
}

/** Calls back with inertial samples, about 200 a second; returns a function that stops it. */
export function listenToMotion(onSample) {
  const order = new AxisOrder(), between = new Between(), sign = gravityIsReversed() ? -1 : 1;
  let last_ns = -Infinity;
  const listener = event => {
    const a = event.accelerationIncludingGravity, r = event.rotationRate;
    if (a?.x == null || r?.alpha == null) return;
    const t_ns = event.timeStamp * 1e6;
    if (t_ns <= last_ns) return; // some browsers give two events with the same time
    last_ns = t_ns;
    const accel = [sign * a.x, sign * a.y, sign * a.z];
    order.see(t_ns / 1e9, accel, r);
    between.add({t_ns, gyro: scale(order.pick(r), DEGREE), accel}).forEach(onSample);
  };
  window.addEventListener('devicemotion', listener);
  return () => window.removeEventListener('devicemotion', listener);
}

/** Calls back with {t_ns, bitmap} of each picture; returns a function that stops it. */
export function listenToCamera(video, onPicture) {
  let running = true, busy = false;
  const take = async (now, metadata) => {
    if (!running) return;
    video.requestVideoFrameCallback(take);
    if (busy) return;
    busy = true;
    const t_ms = metadata.captureTime ?? now - CAPTURE_TO_NOW_MS;
    try {
      onPicture({t_ns: t_ms * 1e6, bitmap: await createImageBitmap(video)});
    } finally {
      busy = false;
    }
  };
  if (typeof video.requestVideoFrameCallback !== 'function') throw new Error('This browser does not give the times of a video’s pictures. Safari 15.4, Chrome 83 or Firefox 132 do.');
  video.requestVideoFrameCallback(take);
  return () => { running = false; };
}

/** Clockwise rotation in degrees that the browser has applied to the sensor's picture: the sensor's rows lie across the
 * upright phone, with the first column at the phone's top, in nearly all rear cameras. The tracker gets the picture in
 * sensor orientation, which it needs for the rolling shutter and which is independent of the screen's rotation. */
export const turnOf = (screen_deg, {width, height}) => ((width < height) === (screen_deg % 180 === 0) ? (450 - screen_deg) % 360 : 0);

/** A guessed calibration, of the picture in sensor orientation. */
export function guessedCamera({width, height, turn_deg, angle_deg, readout_ms}) {
  const [w, h] = turn_deg % 180 === 0 ? [width, height] : [height, width];
  const focal = Math.max(w, h) / 2 / Math.tan(angle_deg * DEGREE / 2);
  return {model: 1, width: w, height: h, distortion_count: 0, fx: focal, fy: focal, cx: (w - 1) / 2, cy: (h - 1) / 2, distortion: Array(8).fill(0),
    q_b_c: [0, Math.SQRT1_2, -Math.SQRT1_2, 0], p_b_c: [0, 0, 0], line_time_ns: Math.round(readout_ms * 1e6 / h)};
}

/** The camera and the pose of the displayed picture: rotated clockwise by turn_deg. */
export function shown(camera, pose, turn_deg) {
  if (!turn_deg) return {camera, pose};
  const {width: w, height: h, fx, fy, cx, cy} = camera, half = -turn_deg * DEGREE / 2;
  const turned = {90: {width: h, height: w, fx: fy, fy: fx, cx: h - 1 - cy, cy: cx}, 180: {cx: w - 1 - cx, cy: h - 1 - cy}, 270: {width: h, height: w, fx: fy, fy: fx, cx: cy, cy: w - 1 - cx}}[turn_deg];
  return {camera: {...camera, ...turned}, pose: pose && {...pose, q_n: multiply(pose.q_n, [Math.cos(half), 0, 0, Math.sin(half)])}};
}

/** Draws a picture rotated back by turn_deg. */
export function drawTurnedBack(context, bitmap, turn_deg) {
  const {width: w, height: h} = bitmap;
  context.setTransform(...{0: [1, 0, 0, 1, 0, 0], 90: [0, -1, 1, 0, 0, w], 180: [-1, 0, 0, -1, w, h], 270: [0, 1, -1, 0, h, 0]}[turn_deg]);
  context.drawImage(bitmap, 0, 0);
}
