// SPDX-License-Identifier: Apache-2.0
// Odograph for Node: the API of @odograph/web (index.d.ts) over the native library, by koffi. Everything runs within push and flush, on
// the thread that calls them: a server calls it from a worker thread.
import koffi from 'koffi';
import * as abi from './abi.js';
import {PROTOTYPES} from './prototypes.js';

export * from './abi.js';

const {STRUCTS, TYPES} = abi;
const NAMES = Object.fromEntries(Object.entries(TYPES).map(([name, number]) => [number, name]));
const ACCESS = {u8: ['Uint8', 1], i32: ['Int32', 4], u32: ['Uint32', 4], i64: ['BigInt64', 8], u64: ['BigUint64', 8], f32: ['Float32', 4], f64: ['Float64', 8]};
const LATEST = -(2n ** 63n);
const CALLBACK = koffi.pointer(koffi.proto('void odo_node_event(void *user, void *event)'));
const RETAIN = koffi.pointer(koffi.proto('int32_t odo_node_retain(uintptr_t owner)')), RELEASE = koffi.pointer(koffi.proto('void odo_node_release(uintptr_t owner)'));

/** What the library answers where it refuses something: `status` is ODO_E_*, the message names what is wrong. */
export class OdographError extends Error {
  constructor(status, text) {
    super(text);
    this.name = 'OdographError';
    this.status = status;
  }
}

const text = (view, at, capacity) => {
  const bytes = new Uint8Array(view.buffer, view.byteOffset + at, capacity), end = bytes.indexOf(0);
  return new TextDecoder().decode(bytes.slice(0, end < 0 ? capacity : end));
};

/** The fields of a struct; what its writer did not have is left out. */
function read(view, name) {
  const out = {}, size = view.getUint32(0, true);
  for (const [label, [code, offset, count = 1]] of Object.entries(STRUCTS[name].fields)) {
    const [method, bytes] = ACCESS[code] ?? [null, 1];
    if (offset + bytes * count > size) continue;
    if (!method) out[label] = text(view, offset, count);
    else if (count === 1) out[label] = view[`get${method}`](offset, true);
    else out[label] = Array.from({length: count}, (_, i) => view[`get${method}`](offset + i * bytes, true));
  }
  return out;
}

/** A zeroed struct with these fields. */
function made(name, values = {}) {
  const {size, fields} = STRUCTS[name], view = new DataView(new ArrayBuffer(size));
  view.setUint32(0, size, true);
  if (name in TYPES) view.setUint32(4, TYPES[name], true);
  for (const [label, value] of Object.entries(values)) {
    if (label === 'type' || label === 'picture') continue;
    if (!fields[label]) throw new OdographError(abi.ODO_E_ARGUMENT, `${name}.${label}: there is no such field; expected one of ${Object.keys(fields).join(', ')}`);
    const [code, offset, count = 1] = fields[label], [method, bytes] = ACCESS[code], list = count === 1 ? [value] : value;
    for (let i = 0; i < Math.min(count, list.length); ++i)
      view[`set${method}`](offset + i * bytes, method.startsWith('Big') ? BigInt(list[i]) : list[i], true);
  }
  return view;
}

/** Text as the fields NAME_data and NAME_size of a struct; `keeps` holds the bytes for as long as they are read. */
function string(field, value, keeps) {
  const bytes = Buffer.from(`${value}\0`);
  keeps.push(bytes);
  return {[`${field}_data`]: koffi.address(bytes), [`${field}_size`]: BigInt(bytes.length - 1)};
}

const bytes = view => Buffer.from(view.buffer);
const message = (address) => {
  const head = new DataView(koffi.view(address, 32)), size = head.getUint32(0, true), name = NAMES[head.getUint32(4, true)];
  return name ? {type: name, ...read(new DataView(koffi.view(address, size)), name)} : {type: String(head.getUint32(4, true)), t_ns: head.getBigInt64(8, true)};
};

/** Loads the library: a path, or what ODOGRAPH_LIBRARY or the dynamic loader finds. */
export function load(path = process.env.ODOGRAPH_LIBRARY ?? 'libodograph.so.0') {
  return new Odograph(koffi.load(path));
}

export class Odograph {
  constructor(library) {
    for (const prototype of PROTOTYPES) this[prototype.match(/(odo_\w+)\(/)[1]] = library.func(prototype);
  }

  get version() { return this.odo_version(); }
  /** Of a status, a state, a reason or a motion mode, in words. */
  statusText(status) { return this.odo_status_text(status); }
  stateText(state) { return this.odo_state_text(state); }
  reasonText(reason) { return this.odo_reason_text(reason); }
  modeText(mode) { return this.odo_mode_text(mode); }

  createSession(options) { return new Session(this, options); }
  /** A recording (*.odo), by its path. */
  openRecording(path) { return new Recording(this, path); }

  // What follows is for this file.
  check(status, error) {
    if (status < 0) throw new OdographError(status, (error && read(error, 'error').message) || this.statusText(status));
    return status;
  }
  created(call) {
    const error = made('error'), handle = new BigUint64Array(1);
    this.check(call(handle, bytes(error)), error);
    return handle[0];
  }
}

export class Session {
  #session; #callback; #thrown = null; #borrowed = new Map(); #next = 1; #retain; #release;

  constructor(library, {config, plugins = '', seed = 0n, events = 'all', onEvent = () => {}}) {
    this.library = library;
    const keeps = [], named = config.includes('\n') ? 'config_text' : 'config_path';
    const options = made('session_options', {run: abi.ODO_RUN_REPLAY, seed, ...string(named, config, keeps), ...string('plugin_path', plugins, keeps)});
    this.#session = library.created((handle, error) => library.odo_session_create(bytes(options), handle, error));
    const hold = by => owner => {
      const picture = this.#borrowed.get(Number(owner));
      picture.holds += by;
      if (picture.holds === 0) this.#borrowed.delete(Number(owner));
      return 0;
    };
    this.#retain = koffi.register(hold(1), RETAIN);
    this.#release = koffi.register(hold(-1), RELEASE);
    const call = (_, event) => {
      try {
        onEvent(message(event));
      } catch (error) { // it cannot cross the library: push or flush throws it
        this.#thrown = error;
      }
    };
    this.#callback = koffi.register(call, CALLBACK);
    const unknown = events !== 'all' && events.find(name => !(name in TYPES));
    if (unknown) throw new OdographError(abi.ODO_E_ARGUMENT, `events: '${unknown}'; expected names of ${Object.keys(TYPES).join(', ')}`);
    const types = events === 'all' ? null : Uint32Array.from(events, name => TYPES[name]);
    library.odo_session_set_callback(this.#session, types, types ? types.length : abi.ODO_ALL_EVENTS, this.#callback, null);
  }

  get #handle() {
    if (!this.#session) throw new OdographError(abi.ODO_E_STATE, 'the session was closed');
    return this.#session;
  }
  #checked(status) {
    const thrown = this.#thrown;
    this.#thrown = null;
    if (thrown) throw thrown;
    return status;
  }

  /** Any input but a frame. Answers the status; what is wrong is in lastError(). */
  push(input) {
    if (!(input.type in TYPES) || input.type === 'frame') throw new OdographError(abi.ODO_E_ARGUMENT, `type: '${input.type}'; expected an input, of frames pushFrame`);
    return this.#checked(this.library.odo_session_push(this.#handle, bytes(made(input.type, input))));
  }

  /** Rotation rate (rad/s) and specific force (m/s^2) in the body's axes. */
  pushImu(t_ns, gyro, accel) {
    return this.#checked(this.library.odo_session_push_imu(this.#handle, BigInt(t_ns), Float64Array.from(gyro), Float64Array.from(accel)));
  }

  /** A picture: `pixels` are width * height bytes (grey), three (RGB) or four times as many (RGBA). It is borrowed, not copied, and must not
   * change as long as `borrowed` counts it. Other fields as odo_frame has them. */
  pushFrame({pixels, width, height, ...fields}) {
    const pixel = pixels.length / (width * height), format = {1: abi.ODO_FORMAT_GREY8, 3: abi.ODO_FORMAT_RGB8, 4: abi.ODO_FORMAT_RGBA8}[pixel];
    if (!format) throw new OdographError(abi.ODO_E_ARGUMENT, `pixels: ${pixels.length} bytes of ${width} x ${height}; expected one, three or four a pixel`);
    const owner = this.#next++;
    const frame = made('frame', {...fields, format, width, height, plane_count: 1, planes0_data: koffi.address(pixels), planes0_row_stride: width * pixel,
      planes0_pixel_stride: pixel, loan_owner: owner, loan_retain: this.#retain, loan_release: this.#release});
    this.#borrowed.set(owner, {pixels, holds: 1});
    try {
      return this.#checked(this.library.odo_session_push(this.#handle, bytes(frame)));
    } finally {
      const picture = this.#borrowed.get(owner);
      if (--picture.holds === 0) this.#borrowed.delete(owner);
    }
  }
  /** How many pictures the library has still borrowed. */
  get borrowed() { return this.#borrowed.size; }

  flush() { return this.#checked(this.library.odo_session_flush(this.#handle)); }

  /** The pose at a time, or the newest; null while there is none. `smooth`: for what is drawn. `of`: ODO_OF_*. */
  pose(t_ns = LATEST, {smooth = false, of = abi.ODO_OF_PIPELINE} = {}) {
    const pose = made('pose');
    const status = this.library.odo_session_get_pose_of(this.#handle, of, smooth ? 1 : 0, BigInt(t_ns), bytes(pose));
    return status === abi.ODO_OK ? {type: 'pose', ...read(pose, 'pose')} : null;
  }

  /** Makes an anchor: odo_anchor_place's fields, and a name. Answers its id. */
  createAnchor({name = '', ...place}) {
    const keeps = [], id = new BigUint64Array(1);
    const view = made('anchor_place', {t_ns: LATEST, ...place, ...string('name', name, keeps)});
    this.library.check(this.library.odo_anchor_create(this.#handle, bytes(view), id));
    return id[0];
  }
  /** The anchor at a time in a world (ODO_WORLD_*), or null. */
  anchor(id, {t_ns = LATEST, world = abi.ODO_WORLD_CORRECTED} = {}) {
    const anchor = made('anchor');
    return this.library.odo_anchor_get(this.#handle, BigInt(id), world, BigInt(t_ns), bytes(anchor)) === abi.ODO_OK ? read(anchor, 'anchor') : null;
  }
  /** The ids of all anchors. */
  anchors() {
    const ids = new BigUint64Array(Number(this.library.odo_anchor_list(this.#handle, null, 0)));
    this.library.odo_anchor_list(this.#handle, ids, ids.length);
    return [...ids];
  }
  removeAnchor(id) { return this.library.odo_anchor_remove(this.#handle, BigInt(id)); }

  statistics() {
    const statistics = made('statistics');
    this.library.check(this.library.odo_session_get_statistics(this.#handle, bytes(statistics)));
    return read(statistics, 'statistics');
  }

  /** The last error or warning since the last call, or null. */
  lastError() {
    const error = made('error');
    return this.library.odo_session_last_error(this.#handle, bytes(error)) === abi.ODO_OK ? null : read(error, 'error').message;
  }

  close() {
    if (!this.#session) return;
    this.library.odo_session_destroy(this.#session);
    [this.#callback, this.#retain, this.#release].forEach(pointer => koffi.unregister(pointer));
    this.#session = 0n;
  }
}

export class Recording {
  #recording; #out = new BigUint64Array(3);

  constructor(library, path) {
    this.library = library;
    const keeps = [], name = new DataView(new ArrayBuffer(16)), {x_data, x_size} = string('x', path, keeps);
    name.setBigUint64(0, x_data, true);
    name.setBigUint64(8, x_size, true);
    this.#recording = library.created((handle, error) => library.odo_recording_open(bytes(name), handle, error));
  }

  /** The next message in the order of time, of a frame with its `picture` (PNG or JPEG, a copy); null at the end. */
  next() {
    const out = this.#out;
    if (this.library.odo_recording_next(this.#recording, out.subarray(0, 1), out.subarray(1, 2), out.subarray(2, 3)) !== abi.ODO_OK) return null;
    const found = message(out[0]);
    if (out[1]) found.picture = new Uint8Array(koffi.view(out[1], Number(out[2]))).slice();
    return found;
  }
  * [Symbol.iterator]() {
    for (let found; (found = this.next());) yield found;
  }

  /** What it lacks of what was written, in words; empty where nothing. */
  loss() {
    const error = made('error');
    this.library.odo_recording_loss(this.#recording, bytes(error));
    return read(error, 'error').message;
  }

  close() {
    if (this.#recording) this.library.odo_recording_close(this.#recording);
    this.#recording = 0n;
  }
}
