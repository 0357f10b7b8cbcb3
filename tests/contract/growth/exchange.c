/* SPDX-License-Identifier: Apache-2.0
 *
 * Runs the output of `abi/generate.py --exchange`:
 *   exchange write FILE
 *   exchange read FILE GROWN      digests of the messages, one a line; GROWN 1: with the fields of the later version */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t odo_read(const unsigned char* bytes, uint32_t size, uint32_t type, uint32_t grown);
uint32_t odo_write(unsigned char* bytes);
extern const uint32_t odo_types[];

int main(int argc, char** argv) {
  static double aligned[8192];
  unsigned char* bytes = (unsigned char*)aligned;
  const uint32_t* type = odo_types;
  const int writes = argc == 3 && strcmp(argv[1], "write") == 0;
  FILE* file = argc >= 3 ? fopen(argv[2], writes ? "wb" : "rb") : NULL;
  size_t size;
  if (!file) return 2;
  if (writes) {
    size = fwrite(bytes, 1, odo_write(bytes), file);
  } else {
    size = fread(bytes, 1, sizeof aligned, file);
    for (; *type; ++type)
      printf("%llu\n", (unsigned long long)odo_read(bytes, (uint32_t)size, *type, (uint32_t)atoi(argv[3])));
  }
  return fclose(file) || size == 0;
}
