// SPDX-License-Identifier: Apache-2.0
// Eigen has no vectors of WebAssembly's own; by -msse2 emscripten makes them of SSE2's. Eigen asks for MMX first, which
// emscripten has not and Eigen does not use, and takes clang for a GCC so old that minima need x86's assembler.
#undef EIGEN_COMP_GNUC
#define EIGEN_COMP_GNUC 0
