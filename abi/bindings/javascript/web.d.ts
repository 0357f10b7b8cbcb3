// SPDX-License-Identifier: Apache-2.0
// Odograph for browsers. It runs on the calling thread, so use it in a Web Worker.
import type {Odograph} from './api.js';
export * from './api.js';

/** `wasm`: URL or bytes of odograph.wasm; by default the file beside index.js. */
export function load(options?: {wasm?: string | URL | ArrayBuffer | Uint8Array}): Promise<Odograph>;
