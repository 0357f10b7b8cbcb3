// SPDX-License-Identifier: Apache-2.0
// Odograph for Node: the API of @odograph/web (api.d.ts) over the native library, using koffi. Processing runs within push and
// flush on the calling thread, so use it in a worker thread of a server.
import koffi from 'koffi';
import * as abi from './abi.js';
import {PROTOTYPES} from './prototypes.js';
import {checkInput, eventTypes, LATEST, OdographError, placeOf, plane, structs} from './structs.js';

export * from './abi.js';
export {OdographError, placeOf};

const {read, message: messageAt, write} = structs('u64');
const CALLBACK = koffi.pointer(koffi.proto('void odo_node_event(void *user, void *event)'));
const RETAIN = koffi.pointer(koffi.proto('int32_t odo_node_retain(uintptr_t owner)')), RELEASE = koffi.pointer(koffi.proto('void odo_node_release(uintptr_t owner)'));

/** Creates a struct with these fields. */
function made(name, values) {
  const view = new DataView(new ArrayBuffer(abi.STRUCTS[name].size));
  write(view, 0, name, values);
  return view;
}

/** A text as the fields NAME_data and NAME_size of a struct; `keeps` keeps the bytes alive. */
function string(field, value, keeps) {
  const bytes = Buffer.from(`${value}\0`);
  keeps.push(bytes);
  return {[`${field}_data`]: koffi.address(bytes), [`${field}_size`]: BigInt(bytes.length - 1)};
}

const bytes = view => Buffer.from(view.buffer);
const message = address => messageAt(new DataView(koffi.view(address, new DataView(koffi.view(address, 4)).getUint32(0, true))), 0);

/** Loads the library: a path, by default ODOGRAPH_LIBRARY or the default of the dynamic loader. */
export function load(path = process.env.ODOGRAPH_LIBRARY ?? 'libodograph.so.1') {
  return new Odograph(koffi.load(path));
}

export class Odograph {
  constructor(library) {
    for (const prototype of PROTOTYPES) this[prototype.match(/(odo_\w+)\(/)[1]] = library.func(prototype);
    const found = this.odo_abi_version();
    if (found >>> 16 !== abi.ODO_ABI_MAJOR) {
      throw new OdographError(abi.ODO_E_VERSION, `the library has ABI ${found >>> 16}.${found & 0xFFFF}, this package ${abi.ODO_ABI_MAJOR}.${abi.ODO_ABI_MINOR}`);
    }
  }

  get version() { return this.odo_version(); }
  /** Text of a status, a state, a reason or a motion mode. */
  statusText(status) { return this.odo_status_text(status); }
  stateText(state) { return this.odo_state_text(state); }
  reasonText(reason) { return this.odo_reason_text(reason); }
  modeText(mode) { return this.odo_mode_text(mode); }

  createSession(options) { return new Session(this, options); }
  /** Opens a recording (*.odo) by its path. */
  openRecording(path) { return new Recording(this, path); }

  // Internal.
  check(status, error) {
    if (status < 0) throw new OdographError(status, (error && read(error, 0, 'error').message) || this.statusText(status));
    return status;
  }
  created(call) {
    const error = made('error'), handle = new BigUint64Array(1);
    this.check(call(handle, bytes(error)), error);
    return handle[0];
  }
}

export class Session {
  #session; #callback; #thrown = null; #calling = false; #borrowed = new Map(); #next = 1; #retain; #release;

  constructor(library, {config, plugins = '', seed = 0n, events = 'all', onEvent = () => {}}) {
    this.library = library;
    const keeps = [], named = /\n|: /.test(config) ? 'config_text' : 'config_path';
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
      const before = this.#calling;
      this.#calling = true;
      try {
        onEvent(message(event));
      } catch (error) { // must not propagate through the library: push or flush rethrows it
        this.#thrown = error;
      } finally {
        this.#calling = before;
      }
    };
    this.#callback = koffi.register(call, CALLBACK);
    const types = eventTypes(events);
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

  /** Pushes any input except a frame. Returns the status; lastError() has the reason. */
  push(input) {
    checkInput(input);
    return this.#checked(this.library.odo_session_push(this.#handle, bytes(made(input.type, input))));
  }

  /** Pushes an inertial sample: rotation rate (rad/s) and specific force (m/s^2) in b. */
  pushImu(t_ns, gyro, accel) {
    return this.#checked(this.library.odo_session_push_imu(this.#handle, BigInt(t_ns), Float64Array.from(gyro), Float64Array.from(accel)));
  }

  /** Pushes a picture: width * height * 1 (grey), 3 (RGB) or 4 (RGBA) bytes. It is borrowed, not copied: do not change it while
   * `borrowed` counts it. `fields`: further fields of odo_frame. */
  pushFrame({pixels, width, height, ...fields}) {
    const owner = this.#next++;
    const frame = made('frame', {...fields, ...plane(pixels, width, height, koffi.address(pixels)), loan_owner: owner, loan_retain: this.#retain, loan_release: this.#release});
    this.#borrowed.set(owner, {pixels, holds: 1});
    try {
      return this.#checked(this.library.odo_session_push(this.#handle, bytes(frame)));
    } finally {
      const picture = this.#borrowed.get(owner);
      if (--picture.holds === 0) this.#borrowed.delete(owner);
    }
  }
  /** Number of pictures that the library still borrows. */
  get borrowed() { return this.#borrowed.size; }

  flush() { return this.#checked(this.library.odo_session_flush(this.#handle)); }

  /** The pose at a time, by default at the newest sample; null if not available. `smooth`: without jumps, for rendering. `of`: ODO_OF_*. */
  pose(t_ns = LATEST, {smooth = false, of = abi.ODO_OF_PIPELINE} = {}) {
    const pose = made('pose');
    const world = smooth ? abi.ODO_WORLD_SMOOTH : abi.ODO_WORLD_CORRECTED;
    const status = this.library.odo_session_get_pose_of(this.#handle, of, world, BigInt(t_ns), bytes(pose));
    return status === abi.ODO_OK ? {type: 'pose', ...read(pose, 0, 'pose')} : null;
  }

  /** Creates an anchor from the fields of odo_anchor_place and a name. Returns its id. */
  createAnchor({name = '', ...place}) {
    const keeps = [], id = new BigUint64Array(1);
    const view = made('anchor_place', {t_ns: LATEST, ...place, ...string('name', name, keeps)});
    this.library.check(this.library.odo_anchor_create(this.#handle, bytes(view), id));
    return id[0];
  }
  /** The anchor at a time in a world (ODO_WORLD_*), or null. */
  anchor(id, {t_ns = LATEST, world = abi.ODO_WORLD_CORRECTED} = {}) {
    const anchor = made('anchor');
    return this.library.odo_anchor_get(this.#handle, BigInt(id), world, BigInt(t_ns), bytes(anchor)) === abi.ODO_OK ? read(anchor, 0, 'anchor') : null;
  }
  /** The ids of all anchors. */
  anchors() {
    const ids = new BigUint64Array(Number(this.library.odo_anchor_list(this.#handle, null, 0)));
    this.library.odo_anchor_list(this.#handle, ids, ids.length);
    return [...ids];
  }
  /** The nearest thing that a ray (fields of odo_ray) hits, or null. placeOf(hit) is its place for createAnchor. */
  hitTest(ray) {
    const from = made('ray', {t_ns: LATEST, ...ray}), hit = made('hit'), count = new Uint32Array(1);
    this.library.check(this.library.odo_session_hit_test(this.#handle, bytes(from), bytes(hit), 1, count));
    return count[0] > 0 ? read(hit, 0, 'hit') : null;
  }
  removeAnchor(id) { return this.library.odo_anchor_remove(this.#handle, BigInt(id)); }

  /** Maps of the places that this session has seen, with its anchors, as bytes for loadMap in a later one; empty if there are none. */
  saveMap() {
    for (let data = new Uint8Array(0);;) {
      const size = this.library.check(Number(this.library.odo_map_save(this.#handle, data, data.length)));
      if (size === data.length) return data;
      data = new Uint8Array(size);
    }
  }
  /** Throws if the map is damaged, or of plugins that the session does not have. */
  loadMap(data) { this.library.check(this.library.odo_map_load(this.#handle, data, data.length)); }

  statistics() {
    const statistics = made('statistics');
    this.library.check(this.library.odo_session_get_statistics(this.#handle, bytes(statistics)));
    return read(statistics, 0, 'statistics');
  }

  /** The latest error or warning since the last call, or null. */
  lastError() {
    const error = made('error');
    this.library.check(this.library.odo_session_last_error(this.#handle, bytes(error)));
    const {status, message} = read(error, 0, 'error');
    return status === abi.ODO_OK ? null : message;
  }

  /** Not within onEvent, where it throws. */
  close() {
    if (!this.#session) return;
    if (this.#calling) throw new OdographError(abi.ODO_E_STATE, 'close() within onEvent: close the session after push or flush has returned');
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

  /** The next message in time order, for a frame with a copy of its `picture` (PNG or JPEG); null at the end. Records that cannot be
   * read are skipped; loss() counts them. */
  next() {
    const out = this.#out;
    let status;
    do status = this.library.odo_recording_next(this.#recording, out.subarray(0, 1), out.subarray(1, 2), out.subarray(2, 3));
    while (status === abi.ODO_E_DATA);
    if (this.library.check(status) !== abi.ODO_OK) return null;
    const found = message(out[0]);
    if (out[1]) found.picture = new Uint8Array(koffi.view(out[1], Number(out[2]))).slice();
    return found;
  }
  * [Symbol.iterator]() {
    for (let found; (found = this.next());) yield found;
  }

  /** Describes missing data; empty if the recording is complete. */
  loss() {
    const error = made('error');
    this.library.check(this.library.odo_recording_loss(this.#recording, bytes(error)));
    return read(error, 0, 'error').message;
  }

  close() {
    if (this.#recording) this.library.odo_recording_close(this.#recording);
    this.#recording = 0n;
  }
}
