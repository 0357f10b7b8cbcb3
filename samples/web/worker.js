// SPDX-License-Identifier: Apache-2.0
// The tracker, in a worker beside the page. Requests are {do: ...}, reports {type: ...}.
import {load, ODO_CALIBRATION_EXTRINSICS, ODO_CALIBRATION_LINE_TIME, ODO_CALIBRATION_TIME_OFFSET, ODO_FORMAT_GREY8, ODO_POSE_METRIC, ODO_POSE_POSITION,
  ODO_ANCHOR_VIEW, ODO_HIT_FLOOR, ODO_HIT_POINT, ODO_IMU_GYRO_CORRECTED, ODO_IMU_GYRO, ODO_IMU_ACCEL, ODO_RAY_VIEW, ODO_SURFACE_FLOOR, ODO_SURFACE_VERTICAL, TYPES, placeOf} from './odograph/index.js';
import {drawTurnedBack} from './live.js';

const EVENTS = ['pose', 'state', 'correction', 'refined', 'report', 'step'];
const FIRST_EVENT = 0x1000; // of the message numbers: recorded events are outputs and are not pushed
const UNDRAWN = 2; // pictures that the page may lag behind; a recording waits for it, a live camera skips
const MARK_AHEAD_M = 3; // distance of a mark where a touch hits nothing
const WAITING_PICTURES = 8; // pictures still without a pose; a live camera drops further ones
const library = load();
let run = null;

library.then(({version}) => postMessage({type: 'ready', version}), error => postMessage({type: 'failed', text: String(error?.message ?? error)}));

/** A session and its data. */
class Run {
  constructor(odograph, config, seed) {
    this.odograph = odograph;
    this.pictures = []; // {t_ns, bitmap, turn_deg}, until their pose arrives
    this.poses = [];
    this.notes = [];
    this.corrections = [];
    this.hits = new Map(); // what each mark was put on, by its id
    this.costs = [];
    this.calibration = null;
    this.state = '';
    this.spent_ms = this.longest_ms = 0;
    this.pace = 1;
    this.undrawn = 0;
    this.paused = this.ended = false;
    this.session = odograph.createSession({config, seed, events: EVENTS, onEvent: event => this.#handleEvent(event)});
  }

  #handleEvent(event) {
    if (event.type === 'pose') this.poses.push(event);
    else if (event.type === 'correction') this.corrections.push(event);
    else if (event.type === 'refined') this.refined = event;
    else if (event.type === 'report' && event.severity >= 2) this.notes.push({text: `${event.plugin}: ${event.text}`, bad: event.severity >= 3});
  }

  calibrate(message) {
    this.calibration = message;
    this.offset_ns = message.flags & ODO_CALIBRATION_TIME_OFFSET ? message.time_offset_ns : 0n;
    this.session.push(message);
  }

  /** Pixels of a bitmap, in the format of the recording or the camera. */
  #pixels(bitmap, grey, turn_deg) {
    const [width, height] = turn_deg % 180 === 0 ? [bitmap.width, bitmap.height] : [bitmap.height, bitmap.width];
    if (this.canvas?.width !== width || this.canvas?.height !== height) {
      this.canvas = new OffscreenCanvas(width, height);
      this.context = this.canvas.getContext('2d', {willReadFrequently: true, alpha: false});
      this.grey = new Uint8Array(width * height);
    }
    drawTurnedBack(this.context, bitmap, turn_deg);
    const {data} = this.context.getImageData(0, 0, width, height);
    if (!grey) return {width, height, pixels: data};
    for (let i = 0; i < this.grey.length; ++i) this.grey[i] = data[4 * i];
    return {width, height, pixels: this.grey};
  }

  picture(fields, bitmap, {grey, turn_deg = 0}) {
    const frame = {...fields, ...this.#pixels(bitmap, grey, turn_deg)};
    this.pictures.push({t_ns: BigInt(fields.t_ns) + (this.offset_ns ?? 0n), bitmap, turn_deg});
    this.costs.push(this.spent_ms);
    if (this.costs.length > 30) this.costs.shift();
    this.spent_ms = 0;
    return this.timed(() => this.session.pushFrame(frame));
  }
  /** Time spent on pushes between two pictures counts for the picture, which waits for the samples that cover it. */
  timed(push) {
    const before = performance.now(), status = push(), took = performance.now() - before;
    this.spent_ms += took;
    this.longest_ms = Math.max(this.longest_ms, took);
    return status;
  }

  /** Posts one message for each picture whose pose is available. */
  report() {
    const {session, odograph} = this;
    for (const pose of this.poses.splice(0)) {
      const at = this.pictures.findIndex(({t_ns}) => t_ns >= pose.t_ns - 1_000n);
      let shown = at >= 0 && this.pictures[at].t_ns <= pose.t_ns + 1_000n ? this.pictures[at] : null;
      if (shown) this.pictures.splice(0, at + 1).slice(0, -1).forEach(({bitmap}) => bitmap.close());
      if (shown && this.undrawn > UNDRAWN) shown = void shown.bitmap.close();
      if (shown) ++this.undrawn;
      const cost = [...this.costs].sort((a, b) => a - b)[this.costs.length >> 1] ?? 0;
      const statistics = session.statistics();
      postMessage({type: 'picture', bitmap: shown?.bitmap ?? null, turn_deg: shown?.turn_deg ?? 0, calibration: this.calibration, pose, marks: this.marks(pose.t_ns), corrections: this.corrections.splice(0),
        metric: (pose.flags & ODO_POSE_METRIC) !== 0, placed: (pose.flags & ODO_POSE_POSITION) !== 0, state: odograph.stateText(pose.state), reason: pose.reason ? odograph.reasonText(pose.reason) : '',
        scale_sigma: statistics.scale_sigma, steps: Number(statistics.steps), cost_ms: cost, notes: this.notes.splice(0), refined: this.refined ?? null}, shown ? [shown.bitmap] : []);
    }
    while (this.pictures.length > WAITING_PICTURES) this.pictures.shift().bitmap.close();
  }

  marks(t_ns) {
    return this.session.anchors().map(id => this.session.anchor(id, {t_ns})).filter(Boolean).map(({p_n, id}) => ({p_n, id: Number(id), ...this.hits.get(id)}));
  }

  /** A mark where the ray of a touch, in the axes of the pose, hits something, or some metres ahead. */
  mark(t_ns, direction) {
    const hit = this.session.hitTest({kind: ODO_RAY_VIEW, t_ns, direction});
    const id = this.session.createAnchor(hit ? placeOf(hit) : {kind: ODO_ANCHOR_VIEW, t_ns, p: direction.map(x => x * MARK_AHEAD_M)});
    this.hits.set(id, hit ? {what: nameOf(hit), own_sigma_m: ownSigma(hit), scale_sigma: hit.scale_sigma} : {what: 'ahead', own_sigma_m: 0});
  }

  end() {
    this.ended = true;
    this.pictures.splice(0).forEach(({bitmap}) => bitmap.close());
    this.recording?.close();
    this.session.close();
  }
}

const nameOf = ({what, surface, surface_kind}) => what === ODO_HIT_POINT ? 'point' : what === ODO_HIT_FLOOR && !surface ? 'assumed floor'
  : surface_kind === ODO_SURFACE_FLOOR ? 'floor' : surface_kind === ODO_SURFACE_VERTICAL ? 'wall' : 'surface';

/** Standard deviation of a distance without that of the scale. */
const ownSigma = ({sigma_m, scale_sigma, distance_m}) => Math.sqrt(Math.max(0, sigma_m ** 2 - (scale_sigma * distance_m) ** 2));

const later = ms => new Promise(done => setTimeout(done, ms));

/** Plays a recording `pace` times as fast as it was taken; 0: as fast as possible. */
async function play(mine) {
  const {session, recording} = mine;
  const first_of_all = performance.now();
  let first_ns = null, begin = first_of_all, rested = begin;
  for (let message; !mine.ended && (message = recording.next());) {
    if (message.type === 'calibration') mine.calibrate(message);
    else if (message.type === 'frame') {
      const {picture, format, exposure_ns, line_time_ns, flags, t_ns, source, fx, fy, cx, cy} = message;
      if (!picture) continue;
      let bitmap;
      try {
        bitmap = await createImageBitmap(new Blob([picture]), {colorSpaceConversion: 'none', premultiplyAlpha: 'none'});
      } catch {
        mine.notes.push({text: `a picture at ${t_ns} ns cannot be read`, bad: true});
        continue;
      }
      mine.picture({t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy}, bitmap, {grey: format === ODO_FORMAT_GREY8});
      mine.report();
      first_ns ??= t_ns;
      for (; !mine.ended;) {
        const due = mine.paused ? Infinity : mine.pace ? begin + Number(t_ns - first_ns) / 1e6 / mine.pace : 0;
        if (mine.paceChanged) begin = performance.now() - Number(t_ns - first_ns) / 1e6 / (mine.pace || 1), mine.paceChanged = false;
        else if (mine.undrawn >= UNDRAWN) await later(4);
        else if (due > performance.now() + 2) await later(Math.min(due - performance.now(), 100));
        else break;
      }
      if (performance.now() - rested > 30) await later(0), rested = performance.now();
    } else if (TYPES[message.type] < FIRST_EVENT) {
      mine.timed(() => session.push(message));
    }
  }
  if (mine.ended) return;
  session.flush();
  mine.report();
  const loss = recording.loss();
  postMessage({type: 'end', loss, statistics: session.statistics(), longest_ms: mine.longest_ms, took_ms: performance.now() - first_of_all, heap_bytes: mine.odograph.module.HEAPU8.length});
}

const failed = error => postMessage({type: 'error', text: String(error?.message ?? error), status: error?.status ?? 0});

async function begin(config, seed = 1) {
  run?.end();
  run = null;
  return run = new Run(await library, config, seed);
}

const ORDERS = {
  async open({bytes, config, pace = 1}) {
    const mine = await begin(config);
    mine.pace = pace;
    mine.recording = mine.odograph.openRecording(new Uint8Array(bytes));
    await play(mine);
  },
  async live({config}) { await begin(config); },
  calibrate({camera, t_ns}) {
    run?.calibrate({type: 'calibration', t_ns: BigInt(Math.round(t_ns)), flags: ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_LINE_TIME, ...camera, line_time_ns: BigInt(camera.line_time_ns), time_offset_ns: 0n});
  },
  imu({t_ns, gyro, accel}) {
    if (!run) return;
    const sample = {type: 'imu', t_ns: Math.round(t_ns), flags: ODO_IMU_GYRO | ODO_IMU_ACCEL | ODO_IMU_GYRO_CORRECTED, gyro_b: gyro, accel_b: accel};
    run.timed(() => run.session.push(sample));
    run.report();
  },
  picture({t_ns, bitmap, turn_deg}) {
    if (!run?.calibration) return bitmap.close();
    run.picture({t_ns: Math.round(t_ns), flags: 0}, bitmap, {grey: false, turn_deg});
    run.report();
  },
  mark({t_ns, direction}) {
    if (!run) return;
    try {
      run.mark(t_ns, direction);
      postMessage({type: 'marks', marks: run.marks(t_ns)});
    } catch (error) {
      run.notes.push({text: `no mark there: ${error.message}`, bad: false});
    }
  },
  drawn() { if (run?.undrawn) --run.undrawn; },
  pause({paused}) { if (run) run.paused = paused, run.paceChanged = true; },
  pace({pace}) { if (run) run.pace = pace, run.paceChanged = true; },
  close() { run?.end(), run = null; },
};

onmessage = ({data}) => {
  try {
    ORDERS[data.do](data)?.catch?.(failed);
  } catch (error) {
    failed(error);
  }
};
