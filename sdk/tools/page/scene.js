// Landmarks and surfaces at the end of the runs, in the track's panel; the panel's keys; the surfaces as a table.
const kSurfaces = {floor: '--good', horizontal: '--accent', vertical: '--fair', other: '--soft'};  // colours of the kinds

const seesScene = data => data.runs.some(run => run.points.length > 0 || run.surfaces.length > 0);

/** Lays landmarks and outlines into the common drawing frame. */
function layScene(run) {
  run.landmarks = layAll(run, run.points);
  run.surfaces.forEach(surface => { surface.laid = layAll(run, surface.outline); });
}

/** Distance of a position from the viewer, up to a constant. */
function depth(p, i) {
  const ahead = Math.sin(map.turn) * (p[i + 1] - map.centre[1]) + Math.cos(map.turn) * (p[i] - map.centre[0]);
  return ahead * Math.sin(map.tilt) + (p[i + 2] - map.centre[2]) * Math.cos(map.tilt);
}

/** Area of a plane, convex outline, m^2. */
function area(p) {
  const sum = [0, 0, 0];
  for (let i = 3; i + 5 < p.length; i += 3) {
    const a = [0, 1, 2].map(k => p[i + k] - p[k]), b = [0, 1, 2].map(k => p[i + 3 + k] - p[k]);
    sum.forEach((_, k) => { sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]; });
  }
  return Math.hypot(...sum) / 2;
}

/** Mean height above where the run ends, m. */
function heightOf(run, surface) {
  let down = 0;
  for (let i = 2; i < surface.laid.length; i += 3) down += 3 * surface.laid[i] / surface.laid.length;
  return run.placed[run.placed.length - 1] - down;
}

function drawScene(g, run, w, h) {
  g.fillStyle = css('--soft');
  for (let i = 0; i < run.landmarks.length; i += 3) {
    const [x, y] = toScreen(run.landmarks, i, w, h);
    g.fillRect(x - 1, y - 1, 2, 2);
  }
  const farthest_first = [...run.surfaces].sort((a, b) => depth(b.laid, 0) - depth(a.laid, 0));
  for (const {kind, laid} of farthest_first) {
    g.fillStyle = g.strokeStyle = css(kSurfaces[kind]);
    g.lineWidth = 1.5;
    g.beginPath();
    for (let i = 0; i < laid.length; i += 3) g.lineTo(...toScreen(laid, i, w, h));
    g.closePath();
    g.globalAlpha = 0.3;
    g.fill();
    g.globalAlpha = 1;
    g.stroke();
  }
}

function drawSceneLegend(g, data, w, h) {
  const kinds = Object.keys(kSurfaces).filter(kind => data.runs.some(run => run.surfaces.some(s => s.kind === kind)));
  g.textAlign = 'left';
  g.fillStyle = css('--panel');
  if (kinds.length) g.fillRect(6, 6, 86, 18 * kinds.length);
  kinds.forEach((kind, k) => {
    const y = 20 + 18 * k;
    g.fillStyle = css(kSurfaces[kind]);
    g.fillRect(12, y - 9, 10, 10);
    g.fillStyle = css('--ink');
    g.fillText(kind, 28, y);
  });
}

/** What the panel shows, for those who do not see it. */
function describeScene(data) {
  const parts = data.runs.filter(run => run.points.length > 0 || run.surfaces.length > 0).map(run => {
    const of = kind => run.surfaces.filter(s => s.kind === kind).length, kinds = Object.keys(kSurfaces).filter(kind => of(kind) > 0);
    return (data.runs.length > 1 ? run.name + ': ' : '') + `${run.points.length / 3} landmarks` + kinds.map(kind => `, ${of(kind)} ${kind}`).join('');
  });
  return 'Track in space. Arrow keys turn and tilt it, plus and minus zoom.' + (parts.length ? ' At the end ' + parts.join('; ') + ' (table Surfaces).' : '');
}

function setUpSurfaces(details) {
  const rows = data.runs.flatMap(run => run.surfaces.map(s => [...(data.runs.length > 1 ? [run.name] : []), s.kind, `${readable(area(s.laid))} m²`,
    `${heightOf(run, s).toFixed(2)} m`, `${(100 * s.sigma_m).toFixed(1)} cm`]));
  const head = [...(data.runs.length > 1 ? ['Run'] : []), 'Surface', 'Area', 'Height above the last pose', 'Sigma'];
  if (rows.length) details.append(element('h2', 'Surfaces'), table(rows, head));
}

function setUpScene() {
  const canvas = document.getElementById('map'), button = document.getElementById('map-scene');
  button.onclick = () => {
    map.scene = !map.scene;
    button.setAttribute('aria-pressed', map.scene);
    if (map.scene && map.tilt === 0) document.getElementById('map-tilt').click();
    redraw();
  };
  canvas.addEventListener('keydown', e => {
    const turn = by => () => { map.turn += by; }, tilt = by => () => { map.tilt = Math.max(0, Math.min(1.5, map.tilt + by)); };
    const act = {ArrowLeft: turn(0.1), ArrowRight: turn(-0.1), ArrowUp: tilt(-0.1), ArrowDown: tilt(0.1), '+': () => zoomMap(1.2), '-': () => zoomMap(1 / 1.2)}[e.key];
    if (!act || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    e.stopPropagation();  // elsewhere these keys move the time
    act();
    redraw();
  });
}
