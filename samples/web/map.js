// SPDX-License-Identifier: Apache-2.0
// The path walked from above, north up if known, with a scale.
const STEPS_M = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const LEAST_M = 8; // of the map's width

export function drawMap(canvas, {path, marks, pose}) {
  const dense = Math.min(window.devicePixelRatio || 1, 2), width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || !height) return;
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) canvas.width = Math.round(width * dense), canvas.height = Math.round(height * dense);
  const context = canvas.getContext('2d'), style = getComputedStyle(document.body), colour = name => style.getPropertyValue(name).trim();
  context.setTransform(dense, 0, 0, dense, 0, 0);
  context.clearRect(0, 0, width, height);
  const points = [...path, ...marks.map(mark => mark.p_n), ...(pose ? [pose.p_n] : [])];
  if (!points.length) return;
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (const p of points) for (const i of [0, 1]) low[i] = Math.min(low[i], p[i]), high[i] = Math.max(high[i], p[i]);
  const middle = [0, 1].map(i => (low[i] + high[i]) / 2);
  const scale = Math.min((width - 40) / Math.max(high[1] - low[1], LEAST_M), (height - 48) / Math.max(high[0] - low[0], LEAST_M * height / width));
  const at = p => [width / 2 + (p[1] - middle[1]) * scale, height / 2 - 6 - (p[0] - middle[0]) * scale];

  const step = STEPS_M.find(m => m * scale >= 56) ?? STEPS_M.at(-1);
  context.strokeStyle = colour('--line');
  context.lineWidth = 1;
  context.beginPath();
  for (const i of [0, 1]) {
    const span = (i ? width : height) / scale / 2 + step;
    for (let m = Math.ceil((middle[i] - span) / step) * step; m < middle[i] + span; m += step) {
      const [x, y] = at(i ? [0, m] : [m, 0]);
      if (i) context.moveTo(x, 0), context.lineTo(x, height);
      else context.moveTo(0, y), context.lineTo(width, y);
    }
  }
  context.stroke();

  context.strokeStyle = colour('--accent');
  context.lineWidth = 3;
  context.lineJoin = context.lineCap = 'round';
  context.beginPath();
  path.forEach((p, i) => context[i ? 'lineTo' : 'moveTo'](...at(p)));
  context.stroke();
  context.fillStyle = '#e8a01a';
  for (const {p_n} of marks) context.beginPath(), context.arc(...at(p_n), 5, 0, 7), context.fill();
  if (pose) {
    const [x, y] = at(pose.p_n), heading = pose.heading;
    context.save();
    context.translate(x, y);
    context.rotate(heading);
    context.fillStyle = colour('--ink');
    context.beginPath();
    context.moveTo(0, -11), context.lineTo(7, 8), context.lineTo(0, 4), context.lineTo(-7, 8);
    context.fill();
    context.restore();
  }
  context.fillStyle = context.strokeStyle = colour('--ink');
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(12, height - 12), context.lineTo(12 + step * scale, height - 12);
  context.stroke();
  context.font = '12px system-ui, sans-serif';
  context.fillText(`${step} m`, 12, height - 18);
}
