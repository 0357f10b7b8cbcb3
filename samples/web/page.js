// SPDX-License-Identifier: Apache-2.0
// The page: user interface. The tracker runs in worker.js.
import {requestCamera, requestMotion, guessedCamera, listenToCamera, listenToMotion, shown, turnOf} from './live.js';
import {drawMap} from './map.js';
import {add, rotate, project, unproject, conjugate, subtract} from './math.js';
import {Overlay} from './overlay.js';

const $ = id => document.getElementById(id);
const HAND_HEIGHT = 0.8; // height of a phone looked at, as a fraction of the walker's height (assumed)
const PATH_STEP_M = 0.05;
const SILENT_AFTER_MS = 3000; // without motion samples a warning is shown
const ASIDE_NOTES = 4;

const HELP = [
  [/isolation/, 'A browser has no processes to put a plugin into. Delete the line with “isolation”, or set it to none.'],
  [/not linked into this program/, 'This page has the plugins of the recommended pipeline. Choose one of those named, or build the package with yours.'],
  [/loads no plugin from a file/, 'Name a plugin by its id; files of plugins are not loaded in a browser.'],
  [/^\/recording|no recording|not a recording|ODOREC/i, 'Choose a file that Odograph wrote (*.odo). Other recordings become one by “odograph convert”.'],
];

const LIBRARY_MISSING = 'The folder odograph beside this page has to hold the package of “packaging/targets wasm”, and the server to deliver it.';
const BROWSER_TOO_OLD = 'A browser of 2022 or later is needed (WebAssembly with SIMD and exceptions).';
/** A module with a v128 local and an exception tag. */
const EXCEPTIONS = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 13, 3, 1, 0, 0, 10, 6, 1, 4, 1, 1, 123, 11]);

const worker = new Worker('worker.js', {type: 'module'});
const overlay = new Overlay($('picture'));
let view, live = null;

function reset() {
  view?.bitmap?.close?.();
  view = {bitmap: null, camera: null, pose: null, path: [], ground: null, marks: [], t_ns: 0n, metric: false, ended: false};
  for (const id of ['distance', 'speed', 'rise', 'scale', 'steps', 'cost']) $(id).textContent = '–';
  $('notes').textContent = '';
  $('labels').textContent = '';
  $('pause').textContent = 'Pause';
  showState('', 'Starting');
}

function showState(state, text) {
  $('state').dataset.state = state;
  if ($('state').textContent !== text) $('state').textContent = text;
}

function note(text, bad = false) {
  const line = document.createElement('li');
  line.textContent = text;
  line.classList.toggle('bad', bad);
  $('notes').append(line);
  while ($('notes').children.length > ASIDE_NOTES) $('notes').firstChild.remove();
}

function show(screen) {
  document.body.dataset.screen = screen;
  $('start').hidden = screen !== 'start';
  $('run').hidden = screen !== 'run';
}

function fail(text) {
  stop();
  $('error-text').textContent = text;
  $('error-help').textContent = HELP.find(([what]) => what.test(text))?.[1] ?? '';
  $('error').hidden = false;
  $('error-close').focus();
}

function stop() {
  live?.stop();
  live = null;
  worker.postMessage({do: 'close'});
  show('start');
}

/** The pipeline, with the person's height in place of the default. */
const pipeline = () => $('config').value.replace(/^(\s*height:\s*)1\.70 m/m, `$1${Number($('height').value).toFixed(2)} m`);

async function openFile(file) {
  reset();
  show('run');
  $('pace-label').hidden = $('pause').hidden = false;
  note(`${file.name}, ${(file.size / 1e6).toFixed(1)} MB`);
  const bytes = await file.arrayBuffer();
  worker.postMessage({do: 'open', bytes, config: pipeline(), pace: Number($('pace').value)}, [bytes]);
}

async function goLive() {
  try {
    await requestMotion(); // first: iOS requires it within the touch
    const stream = await requestCamera();
    reset();
    show('run');
    $('pace-label').hidden = $('pause').hidden = true;
    worker.postMessage({do: 'live', config: pipeline()});
    const video = Object.assign(document.createElement('video'), {muted: true, playsInline: true, srcObject: stream});
    await video.play();
    let camera = null, samples = 0;
    const stopMotion = listenToMotion(sample => { ++samples; worker.postMessage({do: 'imu', ...sample}); });
    const stopCamera = listenToCamera(video, ({t_ns, bitmap}) => {
      const turn_deg = turnOf(screen.orientation?.angle ?? Number(window.orientation ?? 0), bitmap);
      if (!camera) {
        camera = guessedCamera({width: bitmap.width, height: bitmap.height, turn_deg, angle_deg: Number($('angle').value), readout_ms: Number($('readout').value)});
        worker.postMessage({do: 'calibrate', camera, t_ns});
        note(`Guessed: a lens of ${$('angle').value}° over the picture’s longer side, refined while you walk, and ${$('readout').value} ms of readout (Settings).`);
      }
      worker.postMessage({do: 'picture', t_ns, bitmap, turn_deg}, [bitmap]);
    });
    const silence = setTimeout(() => { if (!samples) note('No motion samples arrive: this device has no sensors, or the browser keeps them.', true); }, SILENT_AFTER_MS);
    const awake = await navigator.wakeLock?.request?.('screen').catch(() => null);
    live = {stop() { stopMotion(), stopCamera(), clearTimeout(silence), awake?.release(), stream.getTracks().forEach(track => track.stop()); }};
  } catch (error) {
    fail(error.message);
  }
}

function correct({q_n, p_n}) {
  view.path = view.path.map(p => add(rotate(q_n, p), p_n));
  if (view.ground !== null) view.ground += p_n[2];
}

function showPicture(report) {
  report.corrections.forEach(correct);
  const {pose} = report;
  view.reason = report.reason;
  if (report.bitmap) {
    view.bitmap?.close();
    view.bitmap = report.bitmap;
    const upright = shown(report.calibration, pose, report.turn_deg);
    Object.assign(view, {camera: upright.camera, turn_deg: report.turn_deg, pose: report.placed ? upright.pose : null, t_ns: pose.t_ns});
  }
  if (report.metric && !view.metric) {
    view.metric = true; // what came before was up to scale
    view.path = [];
    view.ground = null;
  }
  if (report.placed && report.metric) {
    view.ground ??= pose.p_n[2] + HAND_HEIGHT * Number($('height').value);
    const last = view.path.at(-1);
    if (!last || Math.hypot(...subtract(last, pose.p_n)) > PATH_STEP_M) view.path.push(pose.p_n);
    view.first ??= pose.p_n[2];
  }
  view.marks = report.marks;
  showState(report.state, report.state === 'tracking' ? (report.metric ? 'Tracking, in metres' : 'Tracking') : `${report.state[0].toUpperCase()}${report.state.slice(1)}${report.reason ? `: ${report.reason}` : ''}`);
  report.notes.forEach(({text, bad}) => note(text, bad));
  showFigures(report, pose);
  draw();
  if (report.bitmap) worker.postMessage({do: 'drawn'});
  window.dispatchEvent(new CustomEvent('odograph-picture', {detail: report})); // for embedding pages and tests
}

function showFigures(report, pose) {
  const metric = report.metric, speed = Math.hypot(...pose.velocity_n);
  $('distance').textContent = metric ? `${pose.distance_m.toFixed(1)} m` : '–';
  $('speed').textContent = metric ? `${speed.toFixed(1)} m/s` : '–';
  $('rise').textContent = metric && view.path.length ? `${(Math.round(10 * (view.path[0][2] - pose.p_n[2])) / 10 || 0).toFixed(1).replace('-', '−')} m` : '–';
  $('scale').textContent = report.scale_sigma > 0 ? `${(100 * report.scale_sigma).toFixed(1)} %` : '–';
  $('steps').textContent = report.steps;
  $('cost').textContent = `${report.cost_ms.toFixed(0)} ms`;
  view.mapped = {p_n: pose.p_n, heading: Math.atan2(...rotate(pose.q_n, [0, 0, 1]).slice(0, 2).reverse())};
}

function draw() {
  overlay.draw({...view, ground: view.metric ? view.ground : null});
  drawMap($('map'), {path: view.path, marks: view.marks, pose: view.metric && view.mapped ? view.mapped : null});
  const labels = $('labels');
  while (labels.children.length > view.marks.length) labels.lastChild.remove();
  view.marks.forEach((mark, i) => {
    const label = labels.children[i] ?? labels.appendChild(document.createElement('span'));
    const seen = view.pose && rotate(conjugate(view.pose.q_n), subtract(mark.p_n, view.pose.p_n));
    const pixel = seen && seen[2] > 0.2 && project(view.camera, seen);
    label.hidden = !pixel;
    if (!pixel) return;
    const [x, y] = overlay.placeOf(pixel, view.camera);
    label.style.left = `${x}px`, label.style.top = `${y}px`;
    label.textContent = `${mark.id} · ${mark.what} · ${Math.hypot(...seen).toFixed(1)} m${tape(view.marks[i - 1], mark)}`;
  });
}

/** The distance of a mark from the one before it, with its standard deviation: a measuring tape. The scale's error is
 * common to both marks. */
function tape(before, mark) {
  if (!before?.own_sigma_m || !mark.own_sigma_m) return '';
  const length_m = Math.hypot(...subtract(mark.p_n, before.p_n));
  const sigma_cm = 100 * Math.hypot(before.own_sigma_m, mark.own_sigma_m, mark.scale_sigma * length_m);
  return ` · ${length_m.toFixed(2)} m ± ${sigma_cm.toFixed(0)} cm from ${before.id}`;
}

/** A mark where a touch meets a surface, a landmark or the floor. */
function touch(event) {
  if (!view.pose || !view.camera) return note('A mark needs a position: walk a few steps first.');
  const box = $('picture').getBoundingClientRect();
  const ray_d = unproject(view.camera, overlay.pixelAt([event.clientX - box.left, event.clientY - box.top], view.camera));
  // In the axes of the tracker's camera, whose picture is in sensor orientation.
  const half = view.turn_deg * Math.PI / 360, q_c_d = [Math.cos(half), 0, 0, -Math.sin(half)];
  worker.postMessage({do: 'mark', t_ns: view.t_ns, direction: rotate(q_c_d, ray_d)});
  $('hint').hidden = true;
}

const HANDLERS = {
  ready({version}) {
    $('loading').textContent = `Version ${version}. Ready.`;
    $('live').disabled = $('file').disabled = false;
  },
  failed({text}) { $('loading').textContent = `The library could not be loaded: ${text}. ${WebAssembly.validate(EXCEPTIONS) ? LIBRARY_MISSING : BROWSER_TOO_OLD}`; },
  picture: showPicture,
  marks({marks}) { view.marks = marks, draw(); },
  end(report) {
    view.ended = true;
    window.dispatchEvent(new CustomEvent('odograph-end', {detail: report}));
    if (report.loss) note(report.loss, true);
    if (!report.statistics.frames) note(`No picture was used: ${view.reason || 'the recording has none, or none with a lens and inertial samples'}.`, true);
    else if (!view.metric) note(`The poses never had a scale in metres: ${view.reason || 'walk some steps, and turn'}.`, true);
    note(`End of the recording. ${report.statistics.frames} pictures in ${(report.took_ms / 1e3).toFixed(1)} s.`);
    $('pause').hidden = true;
  },
  error({text}) { fail(text); },
};
worker.onmessage = ({data}) => HANDLERS[data.type](data);
worker.onerror = event => fail(event.message || `The worker could not be started. ${LIBRARY_MISSING} Or this browser has no module workers: one of 2023 or later has them.`);

$('live').addEventListener('click', goLive);
$('file').addEventListener('change', () => { if ($('file').files[0]) openFile($('file').files[0]); $('file').value = ''; });
$('drop').addEventListener('keydown', event => { if (event.key === 'Enter' || event.key === ' ') event.preventDefault(), $('file').click(); });
$('close').addEventListener('click', stop);
$('error-close').addEventListener('click', () => { $('error').hidden = true; });
$('pause').addEventListener('click', () => {
  const paused = $('pause').textContent === 'Pause';
  $('pause').textContent = paused ? 'Go on' : 'Pause';
  worker.postMessage({do: 'pause', paused});
});
$('pace').addEventListener('change', () => worker.postMessage({do: 'pace', pace: Number($('pace').value)}));
$('picture').addEventListener('pointerdown', touch);
window.addEventListener('resize', () => { if (document.body.dataset.screen === 'run') draw(); });
for (const name of ['dragover', 'dragleave', 'drop'])
  window.addEventListener(name, event => {
    event.preventDefault();
    document.body.classList.toggle('dropping', name === 'dragover');
    const file = name === 'drop' && event.dataTransfer.files[0];
    if (file && !$('file').disabled) $('error').hidden = true, openFile(file);
  });
fetch('walk.yaml').then(answer => answer.text()).then(text => { $('config').value = text; });
