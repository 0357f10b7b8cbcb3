// The camera's picture at the cursor, with what an app would draw: the path ahead on the ground, the horizon, north.

/** Rotates v by q = (w, x, y, z), or by its inverse. */
function rotate(q, v, inverse) {
  const w = q[0], s = inverse ? -1 : 1, x = s * q[1], y = s * q[2], z = s * q[3];
  const u = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
  return [v[0] + w * u[0] + y * u[2] - z * u[1], v[1] + w * u[1] + z * u[0] - x * u[2], v[2] + w * u[2] + x * u[1] - y * u[0]];
}
const quaternionAt = (run, i) => run.q.slice(4 * i, 4 * i + 4);

/** Horizontal viewing direction of the camera in the common drawing frame: unit vector (north, east). */
function directionAt(run, i) {
  const ahead = rotate(run.laid.q, rotate(quaternionAt(run, i), [0, 0, 1]));
  const up = rotate(run.laid.q, rotate(quaternionAt(run, i), [0, -1, 0]));
  const flat = Math.hypot(ahead[0], ahead[1]) > 0.3 ? ahead : up;  // a camera facing down or up: its upper edge
  const length = Math.hypot(flat[0], flat[1]) || 1;
  return [flat[0] / length, flat[1] / length];
}

/** Pixel of a direction in the camera's axes; null behind it. Models as in the contract (samples.h). */
function project(camera, v) {
  if (v[2] < 0.05) return null;
  let x = v[0] / v[2], y = v[1] / v[2];
  const d = camera.distortion;
  if (camera.model === 'equidistant') {
    const r = Math.hypot(x, y), a = Math.atan(r), a2 = a * a;
    const f = r < 1e-9 ? 1 : a * (1 + a2 * ((d[0] || 0) + a2 * ((d[1] || 0) + a2 * ((d[2] || 0) + a2 * (d[3] || 0))))) / r;
    x *= f;
    y *= f;
  } else if (d.length) {
    const r2 = x * x + y * y;
    if (r2 > 4) return null;  // beyond the validity of the polynomial
    const f = (1 + r2 * (d[0] + r2 * (d[1] + r2 * (d[4] || 0)))) / (1 + r2 * ((d[5] || 0) + r2 * ((d[6] || 0) + r2 * (d[7] || 0))));
    [x, y] = [x * f + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x), y * f + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y];
  }
  return [camera.fx * x + camera.cx, camera.fy * y + camera.cy];
}

function drawOverlay(g, data, run, t, toCanvas) {
  const i = before(run.t, t), camera = data.camera;
  if (i < 0 || !camera) return;
  const q = quaternionAt(run, i), p = run.p.slice(3 * i, 3 * i + 3);
  const pixel = v_n => {
    const at = project(camera, rotate(q, v_n, true));
    return at && toCanvas(at);
  };
  const line = (places, colour, width) => {
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.beginPath();
    let pen = false;
    for (const place of places) {
      if (!place) { pen = false; continue; }
      if (pen) g.lineTo(...place); else g.moveTo(...place);
      pen = true;
    }
    g.stroke();
  };
  const horizon = [];
  for (let a = 0; a <= 360; a += 2) horizon.push(pixel([Math.cos(a * Math.PI / 180), Math.sin(a * Math.PI / 180), 0]));
  line(horizon, '#ffffffaa', 1);
  g.font = 'bold 13px system-ui, sans-serif';
  g.textAlign = 'center';
  ['N', 'E', 'S', 'W'].forEach((name, k) => {
    const at = run.north && pixel([Math.cos(k * Math.PI / 2), Math.sin(k * Math.PI / 2), 0]);
    if (!at) return;
    g.fillStyle = '#ffffff';
    g.strokeStyle = '#000000';
    g.lineWidth = 3;
    g.strokeText(name, at[0], at[1] - 5);
    g.fillText(name, at[0], at[1] - 5);
  });
  if (!run.metric) return;
  const way = [];  // the next 20 s, on the ground below the hand
  for (let k = i; k < run.t.length && run.t[k] < t + 20; ++k)
    way.push(pixel([run.p[3 * k] - p[0], run.p[3 * k + 1] - p[1], run.p[3 * k + 2] + data.ground_m - p[2]]));
  line(way, run.colour, 4);
}

const pictures = new Map();
/** The k-th picture, from the page or from `odograph view`. */
function picture(frame, k) {
  if (pictures.has(k)) return pictures.get(k);
  const image = new Image();
  image.onload = redraw;
  image.src = frame.jpeg ? 'data:image/jpeg;base64,' + frame.jpeg : 'picture/' + frame.number;
  if (pictures.size > 200) pictures.delete(pictures.keys().next().value);
  pictures.set(k, image);
  return image;
}

let shown = null;  // shown while the next one loads
function showPicture(data) {
  if (data.frames.length === 0) return;
  document.getElementById('picture-figure').hidden = false;
  const canvas = document.getElementById('picture'), times = data.frames.map(f => f.t);
  view.listeners.push(() => {
    const {g, w, h} = prepare(canvas);
    const k = Math.max(0, before(times, view.now + 1e-6)), wanted = picture(data.frames[k], k);
    if (wanted.complete && wanted.naturalWidth) shown = {image: wanted, t: times[k]};
    if (!shown) return;
    const {image, t} = shown, scale = Math.min(w / image.naturalWidth, h / image.naturalHeight);
    const x0 = (w - scale * image.naturalWidth) / 2, y0 = (h - scale * image.naturalHeight) / 2;
    g.drawImage(image, x0, y0, scale * image.naturalWidth, scale * image.naturalHeight);
    const shrink = data.camera ? scale * image.naturalWidth / data.camera.width : scale;
    g.save();
    g.beginPath();
    g.rect(x0, y0, scale * image.naturalWidth, scale * image.naturalHeight);
    g.clip();
    if (document.getElementById('overlay').checked) drawOverlay(g, data, data.runs[0], t, at => [x0 + shrink * at[0], y0 + shrink * at[1]]);
    g.restore();
    canvas.setAttribute('aria-label', 'Camera picture at ' + t.toFixed(1) + ' s');
  });
}
