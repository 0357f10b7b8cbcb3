// SPDX-License-Identifier: Apache-2.0
// Reads a recording, and tracks a walk live, in JavaScript: node walk.mjs CONFIG.yaml RECORDING.odo
import {load, ODO_ANCHOR_VIEW, ODO_RAY_VIEW, placeOf, TYPES} from '@odograph/node';

const CONFIG = `odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
`;
const odograph = load();

function show(event) {
  if (event.type === 'pose') return showPose(event);
  const {points} = event; // landmarks, the most certain first
  console.log(`points ${points.length} first ${points[0].id} ${points[0].p_c[2]}`);
}

function showPose({t_ns, p_n: [x, y, z], q_n: [qw, qx, qy, qz]}) {
  console.log(`pose ${t_ns} ${x} ${y} ${z} ${qx} ${qy} ${qz} ${qw}`);
}

/** The pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library. */
function decode(picture) {
  const [magic, width, height, depth] = new TextDecoder().decode(picture.subarray(0, 24)).split(/\s/);
  const begin = magic.length + width.length + height.length + depth.length + 4;
  return {width: Number(width), height: Number(height), pixels: picture.subarray(begin, begin + width * height)};
}

/** Puts an anchor on what lies ahead, 45 degrees down: usually the floor. */
function place(session) {
  const hit = session.hitTest({kind: ODO_RAY_VIEW, direction: [0, 1, 1]});
  if (!hit) return;
  const anchor = session.createAnchor({...placeOf(hit), name: 'on the floor'});
  console.log(`hit ${hit.what} ${hit.surface} ${hit.distance_m} anchor ${anchor}`);
}

function replay(config, file) {
  const session = odograph.createSession({config, events: ['pose', 'points'], onEvent: show});
  const recording = odograph.openRecording(file);
  for (const message of recording) {
    const {picture, t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy} = message;
    if (picture) session.pushFrame({t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy, ...decode(picture)});
    else if (TYPES[message.type] < 0x1000) session.push(message); // recorded events are not input
  }
  session.flush();
  place(session);
  recording.close();
  session.close();
}

function live() {
  let steps = 0;
  const pixels = new Uint8Array(64 * 48).fill(90); // as from a camera
  const session = odograph.createSession({config: CONFIG, events: ['step'], onEvent: () => ++steps});
  for (let i = 0; i < 1000; ++i) {
    const t = i * 0.01, t_ns = 1_000_000_000 + i * 10_000_000;
    session.pushImu(t_ns, [0, 0.01, 0], [0.1, 9.81 + 2.2 * Math.sin(12 * t), 0.4]);
    if (i % 10 === 0) session.pushFrame({t_ns, pixels, width: 64, height: 48}); // borrowed, not copied
  }
  session.flush();
  const [north, east, down] = session.pose().p_n;
  const label = session.createAnchor({kind: ODO_ANCHOR_VIEW, p: [0, 0, -3], name: 'a label'});
  const place = session.anchor(label).p_n.map(x => x.toFixed(2));
  console.log(`live ${steps} steps ${north} ${east} ${down} label ${place.join(' ')} borrowed ${session.borrowed}`);
  session.close();
}

replay(process.argv[2], process.argv[3]);
live();
