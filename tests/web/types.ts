// SPDX-License-Identifier: Apache-2.0
// What a user of @odograph/web writes: compiled, where npm's typescript is, never run.
import {load, ODO_ANCHOR_VIEW, ODO_POSE_METRIC, OdographError, type Event, type Pose} from '@odograph/web';

export async function use(): Promise<number> {
  const odograph = await load({wasm: new URL('https://example.org/odograph.wasm')});
  const heard: Event[] = [];
  const session = odograph.createSession({config: 'odograph: 1', events: ['pose', 'state'], onEvent: event => heard.push(event)});
  session.pushImu(1n, [0, 0, 0], new Float64Array([0, 0, 9.8]));
  session.push({type: 'barometer', t_ns: 2, pressure_pa: 101325});
  session.pushFrame({t_ns: 3, pixels: new Uint8Array(4), width: 2, height: 2, line_time_ns: 30000});
  // @ts-expect-error: an event is no input
  session.push({type: 'pose', t_ns: 4n});
  // @ts-expect-error: a barometer has no such field
  session.push({type: 'barometer', t_ns: 4n, pressure_hpa: 1013});
  const pose: Pose | null = session.pose(undefined, {smooth: true});
  const metric = pose !== null && (pose.flags & ODO_POSE_METRIC) !== 0;
  try {
    const id = session.createAnchor({kind: ODO_ANCHOR_VIEW, p: [0, 0, 3], name: 'a thing'});
    const map: Uint8Array = session.saveMap();
    session.loadMap(map);
    return session.anchor(id)?.p_view[2] ?? 0;
  } catch (error) {
    return error instanceof OdographError ? error.status : metric ? 1 : 0;
  } finally {
    session.close();
  }
}
