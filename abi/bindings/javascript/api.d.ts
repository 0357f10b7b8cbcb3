// SPDX-License-Identifier: Apache-2.0
// Odograph for JavaScript: a metric 6-DoF pose of a hand-held phone. Names are those of the C ABI; its headers and docs/abi.md describe
// messages and fields. node.d.ts and web.d.ts declare how each package loads the library.
import type {Anchor, AnchorPlace, Event, Frame, Hit, Input, MessageName, Message, Pose, Ray, Statistics} from './abi.js';
export * from './abi.js';

/** Nanoseconds of the sensor clock: any epoch, one clock for all sensors. */
export type Time = bigint | number;

export class OdographError extends Error {
  /** ODO_E_* */
  readonly status: number;
}

export interface SessionOptions {
  /** YAML text of a pipeline; in Node also the path of a YAML file, which has neither a line break nor ": " in it, one of which every
   * YAML mapping has. In a browser it cannot refer to files. */
  config: string;
  /** Folders that are searched first for plugins (Node only). A browser uses the plugins linked into the library. */
  plugins?: string;
  seed?: bigint | number;
  /** Events for which onEvent is called, within push and flush. */
  events?: 'all' | MessageName[];
  onEvent?: (event: Event) => void;
}

export class Odograph {
  private constructor();
  readonly version: string;
  statusText(status: number): string;
  stateText(state: number): string;
  reasonText(reason: number): string;
  modeText(mode: number): string;
  /** Throws OdographError: invalid config (with line and column), missing plugin. Several sessions may exist at once. */
  createSession(options: SessionOptions): Session;
  /** Opens a recording (*.odo): a path in Node, the bytes of the file in a browser. Throws OdographError if it is not one. */
  openRecording(recording: string | Uint8Array): Recording;
}

/** The place of a hit for createAnchor, in the world of its ray (ODO_WORLD_*). */
export function placeOf(hit: Hit, world?: number): {kind: number; q: number[]; p: number[]; t_ns: bigint; surface: bigint; sigma_m: number; world: number};

/** Fields of a message to push: all are optional, and 64-bit integers may be numbers. */
export type Fields<T> = T extends {type: string} ? {[K in keyof Omit<T, 'type'>]?: T[K] extends bigint ? Time : T[K]} : never;
/** Any input except a frame. */
export type Pushed = {[T in Exclude<Input, Frame> as T['type']]: {type: T['type']} & Fields<T>}[Exclude<Input, Frame>['type']];

export class Session {
  private constructor();
  /** Pushes any input except a frame. Returns ODO_OK or ODO_E_*. */
  push(message: Pushed): number;
  pushImu(t_ns: Time, gyro_b: ArrayLike<number>, accel_b: ArrayLike<number>): number;
  /** Pushes a picture: width * height * 1 (grey), 3 (RGB) or 4 (RGBA) bytes. In Node the bytes are borrowed, not copied: do not
   * change them while `borrowed` counts them. */
  pushFrame(frame: {t_ns: Time; pixels: Uint8Array | Uint8ClampedArray; width: number; height: number} & Omit<Fields<Frame>, 't_ns'>): number;
  /** Number of pictures that the library still borrows. */
  readonly borrowed: number;
  /** Processes all pushed samples without waiting for slower sensors. */
  flush(): number;
  /** The pose at a time, by default at the newest sample; null if not available. `smooth`: without jumps, for rendering. `of`: ODO_OF_*. */
  pose(t_ns?: Time, options?: {smooth?: boolean; of?: number}): Pose | null;
  /** Creates an anchor and returns its id. Throws OdographError for an invalid place or while the position of the phone is unknown. */
  createAnchor(place: Partial<Omit<AnchorPlace, 'name_data' | 'name_size'>> & {kind: number; name?: string}): bigint;
  anchor(id: bigint | number, options?: {t_ns?: Time; world?: number}): Anchor | null;
  anchors(): bigint[];
  /** The nearest thing that a ray hits; null if there is none, or while position or scale are unknown. */
  hitTest(ray: {kind: number; t_ns?: Time} & Partial<Omit<Ray, 'kind' | 't_ns'>>): Hit | null;
  removeAnchor(id: bigint | number): number;
  /** Maps of the places that this session has seen, with its anchors, for loadMap in a later one; empty if there are none. */
  saveMap(): Uint8Array;
  /** Throws if the map is damaged, or of plugins that the session does not have. */
  loadMap(data: Uint8Array): void;
  statistics(): Statistics;
  lastError(): string | null;
  close(): void;
}

export class Recording implements Iterable<Message & {picture?: Uint8Array}> {
  private constructor();
  /** Returns the next message in time order; null at the end. Records that cannot be read are skipped; loss() counts them. */
  next(): (Message & {picture?: Uint8Array}) | null;
  [Symbol.iterator](): Iterator<Message & {picture?: Uint8Array}>;
  loss(): string;
  close(): void;
}
