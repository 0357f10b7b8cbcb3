/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "suite.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

conformance_library odo;
conformance_options options;

/* The list in suite.h repeats the headers' types: a difference is a compiler warning here. */
#define SAME_TYPE(result, name, arguments) \
  typedef char same_type_##name[sizeof(((conformance_library*)0)->name == odo_##name)];
CONFORMANCE_FUNCTIONS(SAME_TYPE)

const char* library_open(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!library) return dlerror();
#define FIND(result, name, arguments) *(void**)(&odo.name) = dlsym(library, "odo_" #name);
  CONFORMANCE_FUNCTIONS(FIND)
  return NULL;
}

const char* library_missing(void) {
  static char names[2048];
  names[0] = 0;
#define MISSING(result, name, arguments) \
  if (!odo.name) strncat(names, " odo_" #name, sizeof names - strlen(names) - 1);
  CONFORMANCE_FUNCTIONS(MISSING)
  return names[0] ? names + 1 : names;
}

odo_string string_of(const char* text) {
  odo_string string;
  memset(&string, 0, sizeof string);
  string.data = text;
  string.size = strlen(text);
  return string;
}

const char* status_name(int64_t status) {
  static const char* const names[] = {
      "ODO_OK",        "ODO_E_ARGUMENT", "ODO_E_DISCARD", "ODO_E_EXHAUSTED", "ODO_E_UNSUPPORTED", "ODO_E_STRUCT_SIZE",
      "ODO_E_VERSION", "ODO_E_STATE",    "ODO_E_CONFIG",  "ODO_E_NOT_FOUND", "ODO_E_DATA",        "ODO_E_MEMORY",
      "ODO_E_ERROR",   "ODO_E_FATAL"};
  static char number[2][32];
  static int next;
  if (status == ODO_NOT_READY) return "ODO_NOT_READY";
  if (status <= 0 && status > -(int64_t)COUNT_OF(names)) return names[-status];
  next = !next;
  snprintf(number[next], sizeof number[next], "%lld", (long long)status);
  return number[next];
}
