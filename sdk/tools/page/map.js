// The track in space, from above or tilted. Data coordinates are north, east, down in metres.
const map = {centre: [0, 0, 0], metre_px: 10, turn: 0, tilt: 0, by_error: false, scene: false, loads: 0};

/** Transforms a position from a run's frame to the common drawing frame. */
function lay(run, p, i) {
  const {q, p: shift, s} = run.laid, [w, x, y, z] = q;
  const v = [s * p[i], s * p[i + 1], s * p[i + 2]];
  const u = [y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0]];
  const r = [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]];
  return [v[0] + 2 * (w * u[0] + r[0]) + shift[0], v[1] + 2 * (w * u[1] + r[1]) + shift[1], v[2] + 2 * (w * u[2] + r[2]) + shift[2]];
}
function layAll(run, p) {
  const out = new Float64Array(p.length);
  for (let i = 0; i < p.length; i += 3) out.set(lay(run, p, i), i);
  return out;
}
function toScreen(p, i, w, h) {
  const n = p[i] - map.centre[0], e = p[i + 1] - map.centre[1], up = map.centre[2] - p[i + 2];
  const c = Math.cos(map.turn), s = Math.sin(map.turn);
  const right = c * e - s * n, ahead = s * e + c * n;
  return [w / 2 + map.metre_px * right, h / 2 - map.metre_px * (ahead * Math.cos(map.tilt) + up * Math.sin(map.tilt))];
}

function fitMap(data, w, h) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = p => {
    for (let i = 0; i < p.length; i += 3)
      for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], p[i + k]); high[k] = Math.max(high[k], p[i + k]); }
  };
  data.runs.forEach(run => take(run.placed));
  if (data.truth) take(data.truth.p);
  if (!(high[0] >= low[0])) return;
  map.centre = low.map((x, k) => (x + high[k]) / 2);
  map.metre_px = 0.9 * Math.min(w / Math.max(1, high[1] - low[1]), h / Math.max(1, high[0] - low[0]));
}

function drawGrid(g, w, h) {
  const step = tick(w / map.metre_px, 7), reach = Math.max(w, h) / map.metre_px;
  const down = map.centre[2], lines = Math.ceil(reach / step);
  const n0 = Math.round(map.centre[0] / step) * step, e0 = Math.round(map.centre[1] / step) * step;
  g.strokeStyle = css('--line');
  g.lineWidth = 1;
  g.beginPath();
  for (let k = -lines; k <= lines; ++k)
    for (const ends of [[n0 + k * step, e0 - reach, down, n0 + k * step, e0 + reach, down], [n0 - reach, e0 + k * step, down, n0 + reach, e0 + k * step, down]]) {
      g.moveTo(...toScreen(ends, 0, w, h));
      g.lineTo(...toScreen(ends, 3, w, h));
    }
  g.stroke();
  g.fillStyle = g.strokeStyle = css('--soft');
  g.textAlign = 'left';
  g.fillRect(12, h - 14, step * map.metre_px, 2);
  g.fillText(readable(step) + ' m', 12, h - 20);
  const x = w - 24, y = 30, a = map.turn;  // north arrow
  g.beginPath();
  g.moveTo(x - 14 * Math.sin(a), y - 14 * Math.cos(a));
  g.lineTo(x + 5 * Math.cos(a), y - 5 * Math.sin(a));
  g.lineTo(x - 5 * Math.cos(a), y + 5 * Math.sin(a));
  g.fill();
  g.textAlign = 'center';
  g.fillText('N', x, y + 20);
}

function drawPath(g, p, w, h, colourOf, width, dash) {
  g.lineWidth = width;
  g.setLineDash(dash || []);
  let colour = null;
  for (let i = 0; i + 3 < p.length; i += 3) {
    const c = colourOf(i / 3);
    if (c !== colour) {
      if (colour !== null) g.stroke();
      colour = c;
      g.strokeStyle = c;
      g.beginPath();
      g.moveTo(...toScreen(p, i, w, h));
    }
    g.lineTo(...toScreen(p, i + 3, w, h));
  }
  if (colour !== null) g.stroke();
  g.setLineDash([]);
}

function drawFixes(g, run, w, h) {
  const f = run.fixes;
  f.t.forEach((t, k) => {
    if (f.p[3 * k] === null) return;
    const at = toScreen(lay(run, f.p, 3 * k), 0, w, h), i = Math.max(0, before(run.t, t));
    const track = toScreen(run.placed, 3 * i, w, h);
    g.strokeStyle = g.fillStyle = f.used[k] ? css('--good') : css('--bad');
    g.globalAlpha = 0.5;
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(...at);
    g.lineTo(...track);
    g.stroke();
    g.globalAlpha = 1;
    g.fillRect(at[0] - 2, at[1] - 2, 4, 4);
  });
}

/** Key frames, the loops that lead back to them, and where the map of an earlier session was recognised. */
function drawPlaces(g, run, w, h) {
  const at = t => toScreen(run.placed, 3 * Math.max(0, before(run.t, t)), w, h);
  g.fillStyle = run.colour;
  for (const t of run.places.key_frames) g.fillRect(at(t)[0] - 1.5, at(t)[1] - 1.5, 3, 3);
  g.lineWidth = 1;
  for (const [from, to, used] of run.places.loops) {
    g.strokeStyle = used ? css('--good') : css('--bad');
    g.beginPath();
    g.moveTo(...at(from));
    g.lineTo(...at(to));
    g.stroke();
  }
  for (const [t, used] of run.places.map_poses) {
    g.strokeStyle = used ? css('--good') : css('--bad');
    g.beginPath();
    g.arc(at(t)[0], at(t)[1], 4, 0, 7);
    g.stroke();
  }
}

function drawHere(g, run, w, h) {
  const i = before(run.t, view.now);
  if (i < 0) return;
  const at = toScreen(run.placed, 3 * i, w, h);
  if (run.sigma.length) {
    const radius = 2 * run.sigma[i] * map.metre_px;
    g.fillStyle = g.strokeStyle = run.colour + '33';
    g.lineWidth = 1.5;
    g.beginPath();
    g.ellipse(at[0], at[1], radius, radius * Math.max(0.15, Math.cos(map.tilt)), 0, 0, 7);
    if (radius < 0.3 * Math.min(w, h)) g.fill(); else g.stroke();  // a filled one would hide the map
  }
  const [n, e] = directionAt(run, i), tip = run.placed.slice(3 * i, 3 * i + 3);
  tip[0] += n * 16 / map.metre_px;
  tip[1] += e * 16 / map.metre_px;
  g.strokeStyle = g.fillStyle = run.colour;
  g.lineWidth = 2.5;
  g.beginPath();
  g.moveTo(...at);
  g.lineTo(...toScreen(tip, 0, w, h));
  g.stroke();
  g.beginPath();
  g.arc(at[0], at[1], 5, 0, 7);
  g.fill();
  g.strokeStyle = css('--back');
  g.stroke();
}

/** Green, yellow, red as x goes from 0 to 1. */
const heat = x => `hsl(${Math.round(130 * (1 - Math.min(1, x)))}, 75%, 45%)`;

/** Error of each pose relative to the largest, for colours. */
function errorParts(run, largest) {
  return Array.from(run.t, t => {
    const k = before(run.error.t, t);
    return k < 0 || run.error.y[k] === null ? 0 : Math.round(20 * run.error.y[k] / largest) / 20;  // few colours draw faster
  });
}
function drawErrorLegend(g, w, h, largest) {
  for (let k = 0; k < 60; ++k) {
    g.fillStyle = heat(k / 60);
    g.fillRect(w - 80 + k, h - 16, 1.5, 6);
  }
  g.fillStyle = css('--soft');
  g.textAlign = 'right';
  g.fillText('error 0 to ' + readable(largest) + ' m', w - 20, h - 22);
}

function showMap(data) {
  const canvas = document.getElementById('map'), several = data.runs.length > 1;
  const states = [css('--soft'), null, css('--fair'), css('--bad')];
  const largest = Math.max(0, ...data.runs.map(run => run.error.y.reduce((a, y) => Math.max(a, y || 0), 0)));
  document.getElementById('map-error').hidden = !(largest > 0 && data.truth);
  if (largest > 0) data.runs.forEach(run => { run.parts = errorParts(run, largest); });
  document.getElementById('map-scene').hidden = !seesScene(data);
  canvas.setAttribute('aria-label', describeScene(data));
  data.runs.forEach(layScene);
  ++map.loads;
  view.listeners.push(() => {
    if (!map.fitted) { fitMap(data, canvas.clientWidth, canvas.clientHeight); map.fitted = !data.live; }
    const {g, w, h} = layered(canvas, [map.centre, map.metre_px, map.turn, map.tilt, map.by_error, map.scene, map.loads], drawUnder);
    for (const run of data.runs) drawHere(g, run, w, h);
  });
  function drawUnder(g, w, h) {
    drawGrid(g, w, h);
    if (map.scene) {
      data.runs.forEach(run => drawScene(g, run, w, h));
      drawSceneLegend(g, data, w, h);
    }
    if (data.truth) drawPath(g, data.truth.p, w, h, () => css('--soft'), 4, []);
    for (const run of data.runs) {
      drawFixes(g, run, w, h);
      drawPlaces(g, run, w, h);
      const colours = several ? () => run.colour : k => states[run.state[k]] || run.colour;
      drawPath(g, run.placed, w, h, map.by_error && run.parts ? k => heat(run.parts[k]) : colours, 2);
    }
    if (map.by_error && largest > 0) drawErrorLegend(g, w, h, largest);
    g.fillStyle = css('--ink');
    data.waypoints.forEach(p => {
      const [x, y] = toScreen(p, 0, w, h);
      g.beginPath();
      g.arc(x, y, 4, 0, 7);
      g.fill();
    });
  }
}

function zoomMap(factor) {
  map.fitted = true;
  map.metre_px = Math.max(0.01, Math.min(5000, map.metre_px * factor));
  redraw();
}

function setUpMap() {
  const canvas = document.getElementById('map');
  let drag = null;
  canvas.addEventListener('pointerdown', e => { canvas.setPointerCapture(e.pointerId); drag = {x: e.offsetX, y: e.offsetY, turn: e.shiftKey || e.button === 2}; });
  canvas.addEventListener('contextmenu', e => e.preventDefault());
  canvas.addEventListener('pointerup', () => { drag = null; });
  canvas.addEventListener('pointermove', e => {
    if (!drag) return;
    map.fitted = true;
    const dx = e.offsetX - drag.x, dy = e.offsetY - drag.y;
    drag.x = e.offsetX;
    drag.y = e.offsetY;
    if (drag.turn || map.tilt > 0 && !e.ctrlKey) {
      map.turn -= dx * 0.008;
      map.tilt = Math.max(0, Math.min(1.5, map.tilt - dy * 0.006));
    } else {
      const c = Math.cos(map.turn), s = Math.sin(map.turn), right = -dx / map.metre_px, ahead = dy / map.metre_px;
      map.centre[0] += c * ahead - s * right;
      map.centre[1] += c * right + s * ahead;
    }
    redraw();
  });
  canvas.addEventListener('wheel', e => { e.preventDefault(); zoomMap(Math.exp(-e.deltaY * 0.0015)); }, {passive: false});
  document.getElementById('map-top').onclick = () => { map.turn = map.tilt = 0; redraw(); };
  document.getElementById('map-tilt').onclick = () => { map.tilt = 1.0; map.turn = 0.6; redraw(); };
  document.getElementById('map-error').onclick = e => { map.by_error = !map.by_error; e.target.setAttribute('aria-pressed', map.by_error); redraw(); };
  document.getElementById('map-fit').onclick = () => { map.fitted = false; redraw(); };
}
