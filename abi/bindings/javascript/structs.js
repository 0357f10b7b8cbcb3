// SPDX-License-Identifier: Apache-2.0
// Reads and writes structs of the ABI in memory, for node.js and web.js.
import * as abi from './abi.js';

const {STRUCTS, TYPES} = abi;
const NAMES = Object.fromEntries(Object.entries(TYPES).map(([name, number]) => [number, name]));
const NUMBERS = {u8: ['Uint8', 1], i32: ['Int32', 4], u32: ['Uint32', 4], i64: ['BigInt64', 8], u64: ['BigUint64', 8], f32: ['Float32', 4], f64: ['Float64', 8]};
export const LATEST = -(2n ** 63n);

/** An error of the library: `status` is ODO_E_*, the message states the reason. */
export class OdographError extends Error {
  constructor(status, text) {
    super(text);
    this.name = 'OdographError';
    this.status = status;
  }
}

/** Type numbers of events given by name; null for all. */
export function eventTypes(events) {
  if (events === 'all') return null;
  const unknown = events.find(name => !(name in TYPES));
  if (unknown) throw new OdographError(abi.ODO_E_ARGUMENT, `events: '${unknown}'; expected names of ${Object.keys(TYPES).join(', ')}`);
  return Uint32Array.from(events, name => TYPES[name]);
}

/** Throws unless the message is an input other than a frame, which needs pushFrame. */
export function checkInput({type}) {
  if (!(type in TYPES) || type === 'frame') throw new OdographError(abi.ODO_E_ARGUMENT, `type: '${type}'; expected an input, of frames pushFrame`);
}

/** The fields of a frame whose pixels start at the address `data`. */
export function plane({length}, width, height, data) {
  const pixel = length / (width * height), format = {1: abi.ODO_FORMAT_GREY8, 3: abi.ODO_FORMAT_RGB8, 4: abi.ODO_FORMAT_RGBA8}[pixel];
  if (!format) throw new OdographError(abi.ODO_E_ARGUMENT, `pixels: ${length} bytes of ${width} x ${height}; expected one, three or four a pixel`);
  return {format, width, height, plane_count: 1, planes0_data: data, planes0_row_stride: width * pixel, planes0_pixel_stride: pixel};
}

/** The place of a hit for createAnchor, in the world of its ray. */
export function placeOf({q_n, p_n, t_ns, surface, sigma_m}, world = abi.ODO_WORLD_CORRECTED) {
  return {kind: abi.ODO_ANCHOR_HIT, q: q_n, p: p_n, t_ns, surface, sigma_m, world};
}

/** Readers and writers for addresses of type 'u32' or 'u64'. A struct starts at offset `at` of a DataView. */
export function structs(pointer) {
  const access = {...NUMBERS, ptr: NUMBERS[pointer]};

  const text = (view, at, capacity) => {
    const bytes = new Uint8Array(view.buffer, view.byteOffset + at, capacity), end = bytes.indexOf(0);
    return new TextDecoder().decode(bytes.slice(0, end < 0 ? capacity : end));
  };

  /** The fields of a struct, without those beyond its size. */
  function read(view, at, name, size = view.getUint32(at, true)) {
    const out = {};
    for (const [label, [code, offset, count = 1]] of Object.entries(STRUCTS[name].fields)) {
      const [method, bytes] = access[code] ?? [null, 1], number = i => view[`get${method}`](at + offset + i * bytes, true);
      if (offset + bytes * count > size) continue;
      if (!method) out[label] = text(view, at + offset, count);
      else out[label] = count === 1 ? number(0) : Array.from({length: count}, (_, i) => number(i));
    }
    return out;
  }

  /** A message with its type as a name. */
  function message(view, at) {
    const type = view.getUint32(at + 4, true), name = NAMES[type];
    if (!name) return {type: String(type), t_ns: view.getBigInt64(at + 8, true)};
    const out = {type: name, ...read(view, at, name)};
    if (name === 'points') out.points = elements(view, at, 'point', out);
    if (name === 'surface') out.outline = elements(view, at, 'vertex', out);
    return out;
  }

  /** The elements behind a message. */
  function elements(view, at, name, {offset, stride, count}) {
    const size = view.getUint32(at, true), found = [];
    for (let begin = offset; found.length < count && stride >= STRUCTS[name].size && begin + stride <= size; begin += stride)
      found.push(read(view, at + begin, name, stride));
    return found;
  }

  /** Writes fields and the header of a struct to zeroed memory. */
  function write(view, at, name, values = {}) {
    const {size, fields} = STRUCTS[name];
    view.setUint32(at, size, true);
    if (name in TYPES) view.setUint32(at + 4, TYPES[name], true);
    for (const [label, value] of Object.entries(values)) {
      if (label === 'type' || label === 'picture') continue;
      if (!fields[label]) throw new OdographError(abi.ODO_E_ARGUMENT, `${name}.${label}: there is no such field; expected one of ${Object.keys(fields).join(', ')}`);
      const [code, offset, count = 1] = fields[label], [method, bytes] = access[code], list = count === 1 ? [value] : value;
      for (let i = 0; i < Math.min(count, list.length); ++i)
        view[`set${method}`](at + offset + i * bytes, method.startsWith('Big') ? BigInt(list[i]) : Number(list[i]), true);
    }
  }

  return {read, message, write};
}
