// Fills the page from its embedded data; with `odograph view`, repeatedly during the run.
let data = null;
const element = (name, text) => { const e = document.createElement(name); if (text !== undefined) e.textContent = text; return e; };

function stateBands() {
  const colours = ['#7a8494', css('--good'), css('--fair'), css('--bad')];
  addBand('State', data.runs.map(run => ({
    name: data.runs.length > 1 ? run.name : '', end: run.t[run.t.length - 1],
    entries: run.states.map(s => ({t: s.t, name: s.text, colour: colours[s.state] || colours[0]}))
  })));
}
function modeBands() {
  const colours = {};
  addBand('Motion', data.runs.map(run => ({
    name: data.runs.length > 1 ? run.name : '', end: run.t.length ? run.t[run.t.length - 1] : 0,
    entries: run.modes.map(m => ({t: m.t, name: m.text.replace(/_/g, ' '), colour: colours[m.text] = colours[m.text] || kColours[Object.keys(colours).length % kColours.length]}))
  })));
}

/** Coordinates and angles of poses in the common drawing frame: north, east, down, m; roll, pitch, yaw, degrees. */
function axesOf(t, p, q, turn) {
  const axes = [0, 1, 2].map(k => Array.from(t, (_, i) => p[3 * i + k])), angles = [[], [], []];
  for (let i = 0; i < t.length; ++i) {
    const x = rotate(turn, rotate(q.slice(4 * i, 4 * i + 4), [1, 0, 0])), y = rotate(turn, rotate(q.slice(4 * i, 4 * i + 4), [0, 1, 0]));
    const z = rotate(turn, rotate(q.slice(4 * i, 4 * i + 4), [0, 0, 1])), d = 180 / Math.PI;
    [Math.atan2(y[2], z[2]), Math.asin(Math.max(-1, Math.min(1, -x[2]))), Math.atan2(x[1], x[0])].forEach((a, k) => {
      const before = angles[k].length ? angles[k][angles[k].length - 1] : a * d;
      angles[k].push(a * d + 360 * Math.round((before - a * d) / 360));  // no jump at 180
    });
  }
  return [...axes, ...angles];
}
function axisCharts(each, named) {
  const ofTruth = data.truth.q ? axesOf(data.truth.t, data.truth.p, data.truth.q, [1, 0, 0, 0]) : null;
  data.runs.forEach(run => { run.axes = axesOf(run.t, run.placed, run.q, run.laid.q); });
  ['x', 'y', 'z', 'Roll', 'Pitch', 'Yaw'].forEach((name, k) => addChart(name, k < 3 ? 'm' : '°', [
    ...(ofTruth ? [{name: 'truth', t: data.truth.t, y: ofTruth[k], colour: css('--soft'), dashed: true}] : []),
    ...each(run => ({name: named(run), t: run.t, y: run.axes[k], colour: run.colour}))]));
  addChart('Relative error', 'm', each(run => ({name: named(run), t: run.relative.t, y: run.relative.y, colour: run.colour, thin: true})), true);
}

function setUpCharts() {
  const each = make => data.runs.flatMap(run => [].concat(make(run) || [])), several = data.runs.length > 1;
  const named = (run, name) => several ? (name ? run.name + ', ' + name : run.name) : name || '';
  if (!data.axes) stateBands();
  modeBands();
  addChart(data.waypoints.length && !data.truth ? 'Error at the waypoints' : 'Error', 'm', each(run => [
    {name: named(run, several ? '' : 'error'), t: run.error.t, y: run.error.y, colour: run.colour, points: !data.truth},
    !several && run.sigma.length ? {name: 'stated sigma', t: run.t, y: run.sigma, colour: css('--soft'), dashed: true} : null
  ].filter(s => s && run.error.t.length)), true);
  if (data.axes) axisCharts(each, named);
  addChart('Metric scale known to', '%', each(run => ({name: named(run), t: run.scale_sigma.t, y: run.scale_sigma.y, colour: run.colour})), true);
  addChart('Scale from its sources', '', each(run => run.scales.map((s, k) =>
    ({name: named(run, s.source), t: s.t, y: s.y, band: s.sigma, colour: kColours[(k + data.runs.indexOf(run)) % kColours.length]}))));
  if (!data.axes) addChart('Height', 'm', each(run => ({name: named(run), t: run.t, y: run.height, colour: run.colour}))
    .concat(data.truth ? [{name: 'truth', t: data.truth.t, y: data.truth.height, colour: css('--soft'), dashed: true}] : []));
  addChart('Speed', 'm/s', each(run => ({name: named(run), t: run.speed.t, y: run.speed.y, colour: run.colour, thin: true})), true);
  addChart('Speed less the true one', 'm/s', each(run => ({name: named(run), t: run.speed_error.t, y: run.speed_error.y, colour: run.colour, thin: true})));
  addChart('Step length', 'm', each(run => ({name: named(run), t: run.steps.t, y: run.steps.y, band: several ? undefined : run.steps.sigma, points: true, colour: run.colour})));
  addChart('Fixes less the track', 'm', each(run => ['north', 'east', 'down'].map((axis, k) =>
    ({name: named(run, axis), t: run.fixes.t, y: run.fixes.residual[k], points: true, colour: kColours[k]})).filter(s => s.y.some(y => y !== null))));
  const corners = (several ? [] : [['followed', 'tracked', '#e0662b']]).concat([['in use', 'inliers', null]]);
  addChart('Corners of the front-end' + (several ? ' in use' : ''), '', each(run => corners.map(([name, key, colour]) =>
    ({name: named(run, several ? '' : name), t: run.corners.t, y: run.corners[key], colour: colour || run.colour, thin: true}))), true);
  addChart('Work for a frame', 'ms', each(run => ({name: named(run), t: run.frame_ms.t, y: run.frame_ms.y, colour: run.colour, thin: true})), true);
}

function table(rows, head) {
  const box = element('div'), out = element('table');
  box.className = 'wide';
  box.tabIndex = 0;  // enables scrolling by keyboard if it is wider than the screen
  if (head) {
    const line = element('tr');
    head.forEach(text => line.append(element('th', text)));
    out.append(line);
  }
  for (const row of rows) {
    const line = element('tr');
    row.forEach((cell, k) => line.append(element(k === 0 ? 'th' : 'td', cell)));
    out.append(line);
  }
  box.append(out);
  return box;
}

function setUpDetails() {
  const details = document.getElementById('details');
  details.append(element('h2', 'Figures'), table(data.runs[0].table.map((row, k) => [row[0], ...data.runs.map(run => run.table[k][1])]),
    data.runs.length > 1 ? ['Figure', ...data.runs.map(run => run.name)] : null));
  setUpSurfaces(details);
  const said = data.runs.flatMap(run => run.reports.map(text => [run.name, text]));
  if (said.length) details.append(element('h2', 'Reported'), table(said));
  details.append(element('h2', 'How it was made'), table(data.about));
  for (const run of data.runs) if (run.config) details.append(element('h2', 'Config of ' + run.name), element('pre', run.config));
}

function setUpTime() {
  const cursor = document.getElementById('cursor'), play = document.getElementById('play');
  cursor.oninput = () => setNow(Number(cursor.value));
  let playing = null;
  const step = time => {
    if (playing === null) return;
    setNow(view.now + (time - playing) / 1000);
    playing = view.now >= view.whole[1] ? null : time;
    play.textContent = playing === null ? '▶' : '❚❚';
    requestAnimationFrame(step);
  };
  play.onclick = () => {
    playing = playing === null ? performance.now() : null;
    play.textContent = playing === null ? '▶' : '❚❚';
    play.setAttribute('aria-label', playing === null ? 'Play' : 'Pause');
    if (playing !== null) requestAnimationFrame(step);
  };
  document.getElementById('zoom-out').onclick = () => setWindow(...view.whole);
  addEventListener('keydown', e => {
    if (e.target.matches('button, input[type=checkbox], pre') && e.key === ' ') return;
    const jump = e.shiftKey ? 5 : 0.5;
    const act = {ArrowLeft: () => setNow(view.now - jump), ArrowRight: () => setNow(view.now + jump), Home: () => setNow(view.whole[0]), End: () => setNow(view.whole[1]),
      ' ': () => play.click(), '+': () => zoom(0.7, view.now), '-': () => zoom(1 / 0.7, view.now), '0': () => setWindow(...view.whole)}[e.key];
    if (act && !e.ctrlKey && !e.metaKey && !e.altKey) { e.preventDefault(); act(); }
  });
}
function drawTime() {
  const cursor = document.getElementById('cursor');
  [cursor.min, cursor.max] = view.whole;
  cursor.value = view.now;
  cursor.setAttribute('aria-valuetext', view.now.toFixed(1) + ' seconds');
  document.getElementById('now').textContent = view.now.toFixed(2) + ' s';
}

function mark(colour, text) {
  const entry = element('li'), square = element('i');
  square.style.background = colour;
  entry.append(square, text);
  document.getElementById('runs').append(entry);
}

function load(fresh) {
  data = fresh;
  for (const id of ['runs', 'charts', 'details']) document.getElementById(id).replaceChildren();
  document.title = document.getElementById('title').textContent = data.title;
  document.getElementById('headline').textContent = (data.live ? 'Running: ' : '') + data.headline;
  data.runs.forEach((run, k) => {
    run.colour = kColours[k % kColours.length];
    run.placed = layAll(run, run.p);
    run.height = Array.from({length: run.t.length}, (_, i) => -run.placed[3 * i + 2]);
    mark(run.colour, run.name + (run.headline && data.runs.length > 1 ? ': ' + run.headline : ''));
  });
  if (data.truth) {
    data.truth.height = Array.from({length: data.truth.t.length}, (_, i) => -data.truth.p[3 * i + 2]);
    mark(css('--soft'), 'truth, with which ' + (data.runs.length > 1 ? 'each run was aligned' : 'the run was aligned') + ' by ' + data.alignment);
  }
  const ends = data.runs.flatMap(run => run.t.length ? [run.t[0], run.t[run.t.length - 1]] : []);
  const [first, last] = view.whole, follows = view.now >= last, all = view.t0 <= first && view.t1 >= last;
  view.whole = ends.length ? [Math.min(...ends), Math.max(...ends)] : [0, 1];
  if (all) [view.t0, view.t1] = view.whole;
  if (follows) view.now = view.whole[1];
  view.listeners = [drawTime];
  showMap(data);
  showPicture(data);
  setUpCharts();
  setUpDetails();
  redraw();
  if (data.live) setTimeout(() => fetch('data').then(answer => answer.json()).then(load), 1000);
}

function start() {
  const first = JSON.parse(document.getElementById('data').textContent);
  view.whole = [0, 0];
  if (!first.live) view.now = -1;  // from the start; a live run is followed
  setUpMap();
  setUpScene();
  setUpTime();
  document.querySelectorAll('.save').forEach(button => {
    button.onclick = () => {
      const link = element('a');
      link.download = button.dataset.for + '.png';
      link.href = document.getElementById(button.dataset.for).toDataURL('image/png');
      link.click();
    };
  });
  document.getElementById('overlay').onchange = redraw;
  addEventListener('resize', redraw);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  addEventListener('beforeprint', () => view.listeners.forEach(draw => draw()));
  [view.t0, view.t1] = [0, 0];
  load(first);
  if (first.axes) document.getElementById('map-error').click();
  if (!first.live) setNow(Number(new URLSearchParams(location.hash.slice(1)).get('t')) || view.whole[0]);  // report.html#t=12.5
}
start();
