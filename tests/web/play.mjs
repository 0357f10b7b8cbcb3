// SPDX-License-Identifier: Apache-2.0
// Plays recordings through @odograph/web as odograph's command line replays them, in node and in a browser.

const FIRST_EVENT = 0x1000;

/** One session and one recording, message by message. `decode`: the grey pixels of an encoded picture, {width, height, pixels}. */
export class Player {
  constructor(odograph, types, bytes, config, seed = 0) {
    this.types = types;
    this.recording = odograph.openRecording(bytes);
    this.poses = [];
    this.pushes_ms = [];
    this.frames_ms = [];
    this.spent_ms = 0;
    this.session = odograph.createSession({config, seed, events: ['pose'], onEvent: ({t_ns, flags, q_n, p_n}) => this.poses.push({t_ns, flags, q_n, p_n})});
  }

  #timed(push) {
    const before = performance.now();
    push();
    const took = performance.now() - before;
    this.pushes_ms.push(took);
    this.spent_ms += took;
  }

  /** False at the end. */
  async next(decode) {
    const message = this.recording.next();
    if (!message) return false;
    if (message.type === 'frame') {
      const {t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy, picture} = message;
      const pixels = await decode(picture);
      this.frames_ms.push(this.spent_ms);
      this.spent_ms = 0;
      this.#timed(() => this.session.pushFrame({t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy, ...pixels}));
    } else if (this.types[message.type] < FIRST_EVENT) {
      this.#timed(() => this.session.push(message));
    }
    return true;
  }

  end() {
    this.#timed(() => this.session.flush());
    const statistics = this.session.statistics();
    this.session.close();
    this.recording.close();
    return statistics;
  }
}

export async function play(odograph, types, bytes, config, decode) {
  const player = new Player(odograph, types, bytes, config);
  while (await player.next(decode)) { /* until the end */ }
  return {poses: player.poses, pushes_ms: player.pushes_ms, frames_ms: player.frames_ms, statistics: player.end()};
}

/** One session that is given a recording again and again, each time later by its length: the bytes of memory after each. */
export async function endure(odograph, types, bytes, config, decode, frames) {
  const session = odograph.createSession({config, events: ['pose'], onEvent: () => {}}), pixels = [], sizes = [];
  let shift = 0n, given = 0;
  while (given < frames) {
    const recording = odograph.openRecording(bytes());
    let first = null, last = 0n, k = 0;
    for (let message; (message = recording.next());) {
      first ??= message.t_ns;
      if (message.t_ns > last) last = message.t_ns;
      const {picture, ...rest} = message;
      rest.t_ns += shift;
      if (message.type !== 'frame') {
        if (types[message.type] < FIRST_EVENT) session.push(rest);
        continue;
      }
      pixels[k] ??= await decode(picture);
      const {t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy} = rest;
      session.pushFrame({t_ns, source, flags, exposure_ns, line_time_ns, fx, fy, cx, cy, ...pixels[k]});
      ++k, ++given;
    }
    recording.close();
    shift += last - first + 100_000_000n;
    sizes.push(odograph.module.HEAPU8.length);
  }
  const {frames: taken} = session.statistics();
  session.close();
  return {sizes, taken: Number(taken)};
}

/** The largest differences from a trajectory.tum (t x y z qx qy qz qw), at its times. */
export function differences(poses, tum) {
  const mine = new Map(poses.map(pose => [Number(pose.t_ns), pose]));
  let metres = 0, degrees = 0, compared = 0, first = -1;
  tum.split('\n').filter(line => line && line[0] !== '#').forEach((line, i) => {
    const [t, x, y, z, qx, qy, qz, qw] = line.split(/\s+/).map(Number);
    const [s, f = ''] = line.split(/\s+/)[0].split('.'), pose = mine.get(Number(BigInt(s) * 1_000_000_000n + BigInt(f.padEnd(9, '0'))));
    if (!pose) return;
    ++compared;
    const [a, b, c, d] = pose.q_n, dot = Math.min(1, Math.abs(a * qw + b * qx + c * qy + d * qz));
    const off = Math.hypot(pose.p_n[0] - x, pose.p_n[1] - y, pose.p_n[2] - z);
    if (off > 1e-6 && first < 0) first = i;
    metres = Math.max(metres, off);
    degrees = Math.max(degrees, 2 * Math.acos(dot) * 180 / Math.PI);
    void t;
  });
  return {metres, degrees, compared, first};
}

export const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];
