/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "suite.h"

#include <dlfcn.h>

conformance_library odo;
conformance_options options;

/* The list in suite.h repeats the headers' types: a difference is a compiler warning here. */
#define SAME_TYPE(result, name, arguments) \
  typedef char same_type_##name[sizeof(((conformance_library*)0)->name == odo_##name)];
CONFORMANCE_FUNCTIONS(SAME_TYPE)

static char missing[2048];

static void lacking(void) { skip_case("the library lacks a function of %s", missing); }

const char* library_open(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!library) return dlerror();
  if (!dlsym(library, "odo_abi_version")) return "it is no libodograph: it has no odo_abi_version";
#define FIND(result, name, arguments)                                                                             \
  *(void**)(&odo.name) = dlsym(library, "odo_" #name);                                                            \
  if (!odo.name) {                                                                                                \
    snprintf(missing + strlen(missing), sizeof missing - strlen(missing), "%sodo_" #name, missing[0] ? " " : ""); \
    odo.name = (result(ODO_CALL*) arguments)lacking;                                                              \
  }
  CONFORMANCE_FUNCTIONS(FIND)
  return NULL;
}

const char* library_missing(void) { return missing; }

odo_string string_of(const char* text) {
  odo_string string;
  memset(&string, 0, sizeof string);
  string.data = text;
  string.size = strlen(text);
  return string;
}

#define STATUS(name) \
  { name, #name }
const named_status statuses[] = {STATUS(ODO_OK),          STATUS(ODO_NOT_READY),     STATUS(ODO_END),
                                 STATUS(ODO_PARTIAL),     STATUS(ODO_E_ARGUMENT),    STATUS(ODO_E_DISCARD),
                                 STATUS(ODO_E_EXHAUSTED), STATUS(ODO_E_UNSUPPORTED), STATUS(ODO_E_STRUCT_SIZE),
                                 STATUS(ODO_E_VERSION),   STATUS(ODO_E_STATE),       STATUS(ODO_E_CONFIG),
                                 STATUS(ODO_E_NOT_FOUND), STATUS(ODO_E_DATA),        STATUS(ODO_E_IO),
                                 STATUS(ODO_E_MEMORY),    STATUS(ODO_E_ERROR),       STATUS(ODO_E_FATAL)};
const size_t status_count = COUNT_OF(statuses);

const char* status_name(int64_t status) {
  static char number[2][32];
  static int next;
  for (size_t i = 0; i < status_count; ++i)
    if (statuses[i].number == status) return statuses[i].name;
  next = !next;
  snprintf(number[next], sizeof number[next], "%lld", (long long)status);
  return number[next];
}
