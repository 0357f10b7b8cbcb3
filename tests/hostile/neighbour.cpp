// SPDX-License-Identifier: Apache-2.0
// A library that needs_neighbour.so looks for in its own folder.
extern "C" __attribute__((visibility("default"))) int hostile_neighbour() { return 7; }
