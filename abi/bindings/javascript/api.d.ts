// SPDX-License-Identifier: Apache-2.0
// Odograph in JavaScript: a metric 6-DoF pose of a hand-held phone. Fields of messages and what they mean: docs/abi.md and the headers of
// the C ABI, whose names these are. node.d.ts and web.d.ts say how each package loads the library.
import type {Anchor, AnchorPlace, Event, Frame, Input, MessageName, Message, Pose, Statistics} from './abi.js';
export * from './abi.js';

/** Nanoseconds of the sensor clock: any epoch, one clock for all sensors. */
export type Time = bigint | number;

export class OdographError extends Error {
  /** ODO_E_* */
  readonly status: number;
}

export interface SessionOptions {
  /** A pipeline's YAML text; in Node also its file, whose path has neither a line break nor ": " in it, one of which every YAML mapping has.
   * A browser has no files that the text could name. */
  config: string;
  /** Folders to look for plugins in before all others, in Node. A browser has those that are linked in. */
  plugins?: string;
  seed?: bigint | number;
  /** Which events onEvent is called with, within push and flush. */
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
  /** Throws OdographError: a bad config with line and column, a plugin that is not there. Several sessions may live at once. */
  createSession(options: SessionOptions): Session;
  /** A path in Node, the file's bytes in a browser. Throws OdographError where that is no recording (*.odo). */
  openRecording(recording: string | Uint8Array): Recording;
}

/** A message's fields as they are handed in: each may be left out, whole numbers of 64 bits may be numbers. */
export type Fields<T> = T extends {type: string} ? {[K in keyof Omit<T, 'type'>]?: T[K] extends bigint ? Time : T[K]} : never;
/** Any input but a frame. */
export type Pushed = {[T in Exclude<Input, Frame> as T['type']]: {type: T['type']} & Fields<T>}[Exclude<Input, Frame>['type']];

export class Session {
  private constructor();
  /** Any input but a frame, with ODO_OK or ODO_E_* as the answer. */
  push(message: Pushed): number;
  pushImu(t_ns: Time, gyro_b: ArrayLike<number>, accel_b: ArrayLike<number>): number;
  /** width * height bytes (grey), three (RGB) or four times as many (RGBA). In Node
   * they are borrowed, not copied, and must not change as long as `borrowed` counts them. */
  pushFrame(frame: {t_ns: Time; pixels: Uint8Array | Uint8ClampedArray; width: number; height: number} & Omit<Fields<Frame>, 't_ns'>): number;
  /** How many pictures the library has still borrowed. */
  readonly borrowed: number;
  /** Processes all that has been pushed, without waiting for slower sensors. */
  flush(): number;
  /** Null while there is none at that time. */
  pose(t_ns?: Time, options?: {smooth?: boolean; of?: number}): Pose | null;
  /** Throws OdographError where the phone's position is not known yet, or for a place that is none. */
  createAnchor(place: Partial<Omit<AnchorPlace, 'name_data' | 'name_size'>> & {kind: number; name?: string}): bigint;
  anchor(id: bigint | number, options?: {t_ns?: Time; world?: number}): Anchor | null;
  anchors(): bigint[];
  removeAnchor(id: bigint | number): number;
  statistics(): Statistics;
  lastError(): string | null;
  close(): void;
}

export class Recording implements Iterable<Message & {picture?: Uint8Array}> {
  private constructor();
  /** In the order of time; null at the end. */
  next(): (Message & {picture?: Uint8Array}) | null;
  [Symbol.iterator](): Iterator<Message & {picture?: Uint8Array}>;
  loss(): string;
  close(): void;
}
