// SPDX-License-Identifier: Apache-2.0
// Odograph for browsers. It runs on the thread that calls it; a page calls it from a Web Worker.
import type {Odograph} from './api.js';
export * from './api.js';

/** `wasm`: where odograph.wasm is, or its bytes; beside index.js unless given. */
export function load(options?: {wasm?: string | URL | ArrayBuffer | Uint8Array}): Promise<Odograph>;
