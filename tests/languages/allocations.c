/* SPDX-License-Identifier: Apache-2.0
 *
 * Preloaded into a program in another language: counts the allocations of the whole process, and stores the addresses
 * of the pixels that a plugin (pixels.cpp) received.
 */
#include <stdint.h>
#include <stdlib.h>

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* pointer, size_t size);

#define VISIBLE __attribute__((visibility("default")))
static uint64_t all, large, largest = UINT64_MAX;
static const void* seen;

static void count(size_t size) {
  __atomic_add_fetch(&all, 1, __ATOMIC_RELAXED);
  if (size >= __atomic_load_n(&largest, __ATOMIC_RELAXED)) __atomic_add_fetch(&large, 1, __ATOMIC_RELAXED);
}

VISIBLE void* malloc(size_t size) { return count(size), __libc_malloc(size); }
VISIBLE void* calloc(size_t number, size_t size) { return count(number * size), __libc_calloc(number, size); }
VISIBLE void* realloc(void* pointer, size_t size) { return count(size), __libc_realloc(pointer, size); }

/* From here on allocations of at least this many bytes are counted as large. */
VISIBLE void odo_test_count(uint64_t bytes) {
  all = large = 0;
  largest = bytes;
}
VISIBLE uint64_t odo_test_all(void) { return all; }
VISIBLE uint64_t odo_test_large(void) { return large; }
VISIBLE void odo_test_see(const void* pixels) { seen = pixels; }
VISIBLE const void* odo_test_seen(void) { return seen; }
