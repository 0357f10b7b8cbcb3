// SPDX-License-Identifier: Apache-2.0
// Odograph for browsers: a typed API (api.d.ts) over the C API (odograph.h), compiled to WebAssembly. It runs on the calling
// thread, so use it in a Web Worker.
import makeModule from './odograph.js';
import * as abi from './abi.js';
import {checkInput, eventTypes, LATEST, OdographError, placeOf, plane, structs} from './structs.js';

export * from './abi.js';
export {OdographError, placeOf};

const {STRUCTS} = abi, {read, message, write} = structs('u32');

/** Loads the library. `wasm`: URL or bytes of odograph.wasm; by default the file beside this one. */
export async function load({wasm} = {}) {
  const options = {};
  if (wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm)) options.wasmBinary = wasm;
  else options.locateFile = () => String(wasm ?? new URL('./odograph.wasm', import.meta.url));
  return new Odograph(await makeModule(options));
}

export class Odograph {
  #files = 0;

  constructor(module) {
    this.module = module;
    const failed = this.#memory(STRUCTS.error.size, error => this.failure(module._odo_web_register(this.ask(error, 'error')), error));
    if (failed) throw failed;
  }

  get version() { return this.module.UTF8ToString(this.module._odo_version()); }
  /** Text of a status, a state, a reason or a motion mode. */
  statusText(status) { return this.module.UTF8ToString(this.module._odo_status_text(status)); }
  stateText(state) { return this.module.UTF8ToString(this.module._odo_state_text(state)); }
  reasonText(reason) { return this.module.UTF8ToString(this.module._odo_reason_text(reason)); }
  modeText(mode) { return this.module.UTF8ToString(this.module._odo_mode_text(mode)); }

  /** Creates a session in replay mode: processing runs within push. `events`: names of the events for onEvent, or 'all'. */
  createSession({config, seed = 0n, events = 'all', onEvent = () => {}}) { return new Session(this, config, BigInt(seed), events, onEvent); }

  /** Opens a recording (*.odo) from its bytes. */
  openRecording(bytes) {
    const path = `/recording-${this.#files++}.odo`;
    this.module.FS.writeFile(path, bytes, {canOwn: true});
    return new Recording(this, path);
  }

  // Internal.
  get view() {
    if (this.#view?.buffer !== this.module.HEAPU8.buffer) this.#view = new DataView(this.module.HEAPU8.buffer);
    return this.#view;
  }
  #view;

  ask(at, name) { return this.view.setUint32(at, STRUCTS[name].size, true), at; }
  #memory(size, work) {
    const at = this.module._malloc(size);
    this.module.HEAPU8.fill(0, at, at + size);
    try {
      return work(at);
    } finally {
      this.module._free(at);
    }
  }
  /** Runs `work` with zeroed temporary memory. */
  using(size, work) { return this.#memory(size, work); }
  withText(text, work) {
    const bytes = new TextEncoder().encode(text);
    return this.#memory(bytes.length + 1, at => (this.module.HEAPU8.set(bytes, at), work(at, bytes.length)));
  }
  putString(at, field, struct, text, size) {
    const {fields} = STRUCTS[struct];
    this.view.setUint32(at + fields[`${field}_data`][1], text, true);
    this.view.setBigUint64(at + fields[`${field}_size`][1], BigInt(size), true);
  }
  failure(status, error) { return status < 0 ? new OdographError(status, this.read(error, 'error').message || this.statusText(status)) : null; }

  // Memory growth replaces the buffer, so that each call needs the current view.
  read(at, name, size) { return read(this.view, at, name, size); }
  message(at) { return message(this.view, at); }
  write(at, name, values) { write(this.view, at, name, values); }
}

export class Session {
  #session; #pixels = 0; #capacity = 0; #scratch; #callback = 0; #thrown = null; #calling = false;

  constructor(library, config, seed, events, onEvent) {
    this.library = library;
    const {module} = library, {size} = STRUCTS.session_options;
    library.withText(config, (text, length) => library.using(size + STRUCTS.error.size + 4, at => {
      const error = library.ask(at + size, 'error'), handle = at + size + STRUCTS.error.size;
      library.write(at, 'session_options', {run: abi.ODO_RUN_REPLAY, seed});
      library.putString(at, 'config_text', 'session_options', text, length);
      const failed = library.failure(module._odo_session_create(at, handle, error), error);
      if (failed) throw failed;
      this.#session = library.view.getUint32(handle, true);
    }));
    this.#scratch = module._malloc(Math.max(...Object.values(STRUCTS).map(struct => struct.size)));
    this.#listen(events, onEvent);
  }

  #listen(events, onEvent) {
    const {library, library: {module}} = this;
    const call = (user, event) => {
      const before = this.#calling;
      this.#calling = true;
      try {
        onEvent(library.message(event));
      } catch (error) { // must not propagate through the library: push or flush rethrows it
        this.#thrown = error;
      } finally {
        this.#calling = before;
      }
    };
    this.#callback = module.addFunction(call, 'vii');
    const types = eventTypes(events);
    if (!types) return module._odo_session_set_callback(this.#session, 0, abi.ODO_ALL_EVENTS, this.#callback, 0);
    library.using(4 * types.length + 4, at => {
      types.forEach((type, i) => library.view.setUint32(at + 4 * i, type, true));
      return module._odo_session_set_callback(this.#session, at, types.length, this.#callback, 0);
    });
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
  push(message) {
    checkInput(message);
    const {library} = this, at = this.#scratch;
    library.module.HEAPU8.fill(0, at, at + STRUCTS[message.type].size);
    library.write(at, message.type, message);
    return this.#checked(library.module._odo_session_push(this.#handle, at));
  }

  /** Pushes an inertial sample: rotation rate (rad/s) and specific force (m/s^2) in b. */
  pushImu(t_ns, gyro, accel) { return this.push({type: 'imu', t_ns, flags: abi.ODO_IMU_GYRO | abi.ODO_IMU_ACCEL, gyro_b: gyro, accel_b: accel}); }

  /** Pushes a picture, which is copied: width * height * 1 (grey), 3 (RGB) or 4 (RGBA) bytes. `fields`: further fields of odo_frame. */
  pushFrame({pixels, width, height, ...fields}) {
    const {library, library: {module}} = this, handle = this.#handle;
    if (pixels.length > this.#capacity) {
      module._free(this.#pixels);
      this.#pixels = module._malloc(pixels.length);
      this.#capacity = pixels.length;
    }
    module.HEAPU8.set(pixels, this.#pixels);
    const at = this.#scratch;
    module.HEAPU8.fill(0, at, at + STRUCTS.frame.size);
    library.write(at, 'frame', {...fields, ...plane(pixels, width, height, this.#pixels), loan_retain: 0, loan_release: 0});
    return this.#checked(module._odo_session_push(handle, at));
  }

  /** Number of pictures that the library still borrows: always 0, because it copies them. */
  get borrowed() { return 0; }

  flush() { return this.#checked(this.library.module._odo_session_flush(this.#handle)); }

  /** The pose at a time, by default at the newest sample; null if not available. `smooth`: without jumps, for rendering. `of`: ODO_OF_*. */
  pose(t_ns = LATEST, {smooth = false, of = abi.ODO_OF_PIPELINE} = {}) {
    const {library} = this, at = library.ask(this.#scratch, 'pose');
    const world = smooth ? abi.ODO_WORLD_SMOOTH : abi.ODO_WORLD_CORRECTED;
    const status = library.module._odo_session_get_pose_of(this.#handle, of, world, BigInt(t_ns), at);
    return status === abi.ODO_OK ? {type: 'pose', ...library.read(at, 'pose')} : null;
  }

  /** Creates an anchor from the fields of odo_anchor_place and a name. Returns its id. */
  createAnchor({name = '', ...place}) {
    const {library, library: {module}} = this, {size} = STRUCTS.anchor_place;
    return library.withText(name, (text, length) => library.using(size + 8, at => {
      library.write(at, 'anchor_place', {t_ns: LATEST, ...place});
      library.putString(at, 'name', 'anchor_place', text, length);
      const status = module._odo_anchor_create(this.#handle, at, at + size);
      if (status < 0) throw new OdographError(status, library.statusText(status));
      return library.view.getBigUint64(at + size, true);
    }));
  }
  /** The anchor at a time in a world (ODO_WORLD_*), or null. */
  anchor(id, {t_ns = LATEST, world = abi.ODO_WORLD_CORRECTED} = {}) {
    const {library} = this, at = library.ask(this.#scratch, 'anchor');
    return library.module._odo_anchor_get(this.#handle, BigInt(id), world, BigInt(t_ns), at) === abi.ODO_OK ? library.read(at, 'anchor') : null;
  }
  /** The ids of all anchors. */
  anchors() {
    const {library, library: {module}} = this, count = Number(module._odo_anchor_list(this.#handle, 0, 0n));
    return library.using(8 * count + 8, at => {
      module._odo_anchor_list(this.#handle, at, BigInt(count));
      return Array.from({length: count}, (_, i) => library.view.getBigUint64(at + 8 * i, true));
    });
  }
  /** The nearest thing that a ray (fields of odo_ray) hits, or null. placeOf(hit) is its place for createAnchor. */
  hitTest(ray) {
    const {library, library: {module}} = this, from = STRUCTS.ray.size, size = STRUCTS.hit.size;
    return library.using(from + size + 8, at => {
      library.write(at, 'ray', {t_ns: LATEST, ...ray});
      library.write(at + from, 'hit');
      const status = module._odo_session_hit_test(this.#handle, at, at + from, 1, at + from + size);
      if (status < 0) throw new OdographError(status, library.statusText(status));
      return library.view.getUint32(at + from + size, true) > 0 ? library.read(at + from, 'hit') : null;
    });
  }
  removeAnchor(id) { return this.library.module._odo_anchor_remove(this.#handle, BigInt(id)); }

  /** Maps of the places that this session has seen, with its anchors, as bytes for loadMap in a later one; empty if there are none. */
  saveMap() {
    const {library, library: {module}} = this;
    for (let capacity = 0;;) {
      const [size, data] = library.using(capacity + 1, at => {
        const size = Number(module._odo_map_save(this.#handle, at, BigInt(capacity)));
        return [size, module.HEAPU8.slice(at, at + capacity)];
      });
      if (size < 0) throw new OdographError(size, library.statusText(size));
      if (size === capacity) return data;
      capacity = size;
    }
  }
  /** Throws if the map is damaged, or of plugins that the session does not have. */
  loadMap(data) {
    const {library, library: {module}} = this;
    const status = library.using(data.length + 1, at => (module.HEAPU8.set(data, at), module._odo_map_load(this.#handle, at, BigInt(data.length))));
    if (status < 0) throw new OdographError(status, library.statusText(status));
  }

  statistics() {
    const {library} = this, at = library.ask(this.#scratch, 'statistics');
    library.module._odo_session_get_statistics(this.#handle, at);
    return library.read(at, 'statistics');
  }

  /** The latest error or warning since the last call, or null. */
  lastError() {
    const {library} = this, at = library.ask(this.#scratch, 'error');
    library.module._odo_session_last_error(this.#handle, at);
    const {status, message} = library.read(at, 'error');
    return status === abi.ODO_OK ? null : message;
  }

  /** Not within onEvent, where it throws. */
  close() {
    if (this.#calling) throw new OdographError(abi.ODO_E_STATE, 'close() within onEvent: close the session after push or flush has returned');
    const {module} = this.library;
    module._odo_session_destroy(this.#session);
    if (this.#session) [this.#pixels, this.#scratch].forEach(at => module._free(at)), module.removeFunction(this.#callback);
    this.#session = 0;
  }
}

export class Recording {
  #recording; #out;

  constructor(library, path) {
    this.library = library;
    this.path = path;
    const {module} = library;
    try {
      library.withText(path, (text, length) => library.using(16 + STRUCTS.error.size + 4, at => {
        const error = library.ask(at + 16, 'error'), handle = at + 16 + STRUCTS.error.size;
        library.view.setUint32(at, text, true);
        library.view.setBigUint64(at + 8, BigInt(length), true);
        const failed = library.failure(module._odo_recording_open(at, handle, error), error);
        if (failed) throw failed;
        this.#recording = library.view.getUint32(handle, true);
      }));
    } catch (error) {
      module.FS.unlink(path);
      throw error;
    }
    this.#out = module._malloc(16);
  }

  /** The next message in time order, for a frame with a copy of its `picture` (PNG or JPEG); null at the end. Records that cannot be
   * read are skipped; loss() counts them. */
  next() {
    const {library, library: {module}} = this, out = this.#out;
    let status;
    do status = module._odo_recording_next(this.#recording, out, out + 4, out + 8);
    while (status === abi.ODO_E_DATA);
    if (status < 0) throw new OdographError(status, library.statusText(status));
    if (status !== abi.ODO_OK) return null;
    const message = library.message(library.view.getUint32(out, true)), picture = library.view.getUint32(out + 4, true);
    if (picture) message.picture = module.HEAPU8.slice(picture, picture + Number(library.view.getBigUint64(out + 8, true)));
    return message;
  }

  * [Symbol.iterator]() {
    for (let found; (found = this.next());) yield found;
  }

  /** Describes missing data; empty if the recording is complete. */
  loss() {
    const {library} = this;
    return library.using(STRUCTS.error.size, at => (library.module._odo_recording_loss(this.#recording, library.ask(at, 'error')), library.read(at, 'error').message));
  }

  close() {
    if (!this.#recording) return;
    const {module} = this.library;
    module._odo_recording_close(this.#recording);
    module._free(this.#out);
    module.FS.unlink(this.path);
    this.#recording = 0;
  }
}
