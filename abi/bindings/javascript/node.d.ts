// SPDX-License-Identifier: Apache-2.0
// Odograph for Node, over the native library. It runs on the calling thread, so use it in a worker thread of a server.
import type {Odograph} from './api.js';
export * from './api.js';

/** Path of the library; by default ODOGRAPH_LIBRARY or the default of the dynamic loader. */
export function load(path?: string): Odograph;
