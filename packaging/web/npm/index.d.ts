// SPDX-License-Identifier: Apache-2.0
// Odograph for browsers: a metric 6-DoF pose of a hand-held phone. It runs on the thread that calls it; a page calls it from a
// Web Worker. Fields of messages and what they mean: docs/abi.md and the headers of the C ABI, whose names these are.
import type {Anchor, AnchorPlace, Event, Frame, Input, MessageName, Message, Pose, Statistics} from './abi.js';
export * from './abi.js';

/** Nanoseconds of the sensor clock: any epoch, one clock for all sensors. */
export type Time = bigint | number;

export class OdographError extends Error {
  /** ODO_E_* */
  readonly status: number;
}

/** `wasm`: where odograph.wasm is, or its bytes; beside index.js unless given. */
export function load(options?: {wasm?: string | URL | ArrayBuffer | Uint8Array}): Promise<Odograph>;

export interface SessionOptions {
  /** A pipeline's YAML text. Files that it names do not exist here. */
  config: string;
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
  /** Throws OdographError: a bad config with line and column, a plugin that is not linked in. Several sessions may live at once. */
  createSession(options: SessionOptions): Session;
  /** Throws OdographError where the bytes are no recording (*.odo). */
  openRecording(bytes: Uint8Array): Recording;
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
  /** width * height bytes (grey), or four times as many (RGBA). They are copied. */
  pushFrame(frame: {t_ns: Time; pixels: Uint8Array | Uint8ClampedArray; width: number; height: number} & Omit<Fields<Frame>, 't_ns'>): number;
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

export class Recording {
  private constructor();
  /** In the order of time; null at the end. */
  next(): (Message & {picture?: Uint8Array}) | null;
  loss(): string;
  close(): void;
}
