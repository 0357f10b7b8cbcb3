// SPDX-License-Identifier: Apache-2.0
// Odograph for Node, by the native library. It runs on the thread that calls it; a server calls it from a worker thread.
import type {Odograph} from './api.js';
export * from './api.js';

/** A path of the library; ODOGRAPH_LIBRARY or what the dynamic loader finds unless given. */
export function load(path?: string): Odograph;
