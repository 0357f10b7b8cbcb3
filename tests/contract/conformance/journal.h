/* SPDX-License-Identifier: Apache-2.0
 *
 * Calls of the suite's plugins in order, and the plugins' answers. */
#ifndef CONFORMANCE_JOURNAL_H
#define CONFORMANCE_JOURNAL_H

#include <pthread.h>

#include "probe.h"
#include "suite.h"

typedef struct journal_entry {
  uint32_t what;   /* PROBE_* */
  uint32_t number; /* of the instance, 0 in the entry */
  char plugin[40];
  char kind[40];
  pthread_t thread;
  odo_header* message; /* a complete copy of the input; null otherwise */
  uint64_t size;       /* count of a batch, bytes of a blob */
} journal_entry;

/* The plugins' answers. Set before the session is created, or while nothing is pushed. */
typedef struct journal_hooks {
  /* For each message. process returns a status below 0. May be null. */
  int32_t (*on_message)(odo_instance* instance, const odo_header* message);
  /* For each other call; also for PROBE_PROCESS, after its messages. May be null. */
  int64_t (*on_call)(probe_call* call);
} journal_hooks;
extern journal_hooks hooks;

#define ANY_KIND NULL
/* Entries of a call; of one kind (ODO_INTERFACE_*) or ANY_KIND. */
size_t journal_count(uint32_t what, const char* kind);
/* The entry `index` of these; null if there are fewer. Entries do not move. */
const journal_entry* journal_find(uint32_t what, const char* kind, size_t index);
/* Messages of a type received by a kind. */
size_t given_count(uint32_t type, const char* kind);
const odo_header* given_message(uint32_t type, const char* kind, size_t index);
/* Number of overlapping calls of one instance. */
unsigned journal_overlaps(void);
/* All calls so far as text for a failure message: "create configure activate ...". */
const char* journal_words(const char* kind);
void journal_clear(void);

/* Emits an event of an instance. */
int32_t probe_emit(odo_instance* instance, const void* event);

#endif
