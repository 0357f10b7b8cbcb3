// SPDX-License-Identifier: Apache-2.0
// Included by the mutated files: the environment chooses the mutant that runs (mutate.py).
#pragma once
#include <cstdlib>
#include <fcntl.h>
#include <sys/mman.h>
struct OdoMutant {
  int chosen = -1;
  unsigned char* reached = nullptr;
  OdoMutant() {
    if (const char* number = std::getenv("ODO_MUTANT")) chosen = std::atoi(number);
    const char* name = std::getenv("ODO_MUTANTS_REACHED");
    const int file = name != nullptr ? open(name, O_RDWR | O_CLOEXEC) : -1;
    if (file < 0) return;
    void* bytes = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (bytes != MAP_FAILED) reached = static_cast<unsigned char*>(bytes);
  }
};
__attribute__((visibility("hidden"))) inline bool odo_mutant(int number) {
  static const OdoMutant mutant;
  if (mutant.reached != nullptr) mutant.reached[number] = 1;
  return mutant.chosen == number;
}
