// SPDX-License-Identifier: Apache-2.0
// Quaternions w, x, y, z and vectors, as in the ABI.

export function rotate(q, v) {
  const [w, x, y, z] = q, [a, b, c] = v;
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

export const conjugate = ([w, x, y, z]) => [w, -x, -y, -z];

export function multiply([a, b, c, d], [e, f, g, h]) {
  return [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
}

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = a => Math.hypot(...a);
export const scale = (a, s) => a.map(x => s * x);

const KANNALA_BRANDT = 2;

/** Pixel of a point in the camera's axes by OpenCV's models; null behind the camera. */
export function project(camera, [x, y, z]) {
  if (z <= 1e-6) return null;
  const k = camera.distortion, a = x / z, b = y / z, r2 = a * a + b * b;
  let u = a, v = b;
  if (camera.model === KANNALA_BRANDT) {
    const r = Math.sqrt(r2), t = Math.atan(r), t2 = t * t;
    const s = r > 1e-9 ? t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r : 1;
    u = a * s, v = b * s;
  } else if (camera.distortion_count > 0) {
    const s = (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    u = a * s + 2 * k[2] * a * b + k[3] * (r2 + 2 * a * a), v = b * s + k[2] * (r2 + 2 * b * b) + 2 * k[3] * a * b;
  }
  return [camera.fx * u + camera.cx, camera.fy * v + camera.cy];
}

/** Direction of a pixel in the camera's axes, by fixed-point iteration: for touches. */
export function unproject(camera, [px, py]) {
  const want = [(px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy];
  const at = [...want];
  for (let i = 0; i < 12; ++i) {
    const got = project(camera, [at[0], at[1], 1]);
    at[0] += want[0] - (got[0] - camera.cx) / camera.fx, at[1] += want[1] - (got[1] - camera.cy) / camera.fy;
  }
  const n = Math.hypot(at[0], at[1], 1);
  return [at[0] / n, at[1] / n, 1 / n];
}
