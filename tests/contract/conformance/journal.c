/* SPDX-License-Identifier: Apache-2.0 */
#include "journal.h"

journal_hooks hooks;

/* Allocated one by one, so that entries do not move. */
static struct {
  pthread_mutex_t lock;
  journal_entry** entries;
  size_t count, capacity;
  unsigned overlaps;
} journal = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void note(const probe_call* call, uint32_t what, const odo_header* message) {
  journal_entry* entry = (journal_entry*)calloc(1, sizeof *entry);
  entry->what = what;
  entry->thread = pthread_self();
  if (call->instance) {
    entry->number = call->instance->number;
    memcpy(entry->plugin, call->instance->plugin, sizeof entry->plugin);
    memcpy(entry->kind, call->instance->kind, sizeof entry->kind);
  }
  if (message) {
    entry->message = (odo_header*)malloc(message->struct_size);
    memcpy(entry->message, message, message->struct_size);
  }
  entry->size = call->batch ? call->batch->count : call->size;
  if (journal.count == journal.capacity) {
    journal.capacity = journal.capacity ? 2 * journal.capacity : 1024;
    journal.entries = (journal_entry**)realloc(journal.entries, journal.capacity * sizeof(journal_entry*));
  }
  journal.entries[journal.count++] = entry;
}

static int32_t give(const probe_call* call) {
  int32_t status = ODO_OK;
  for (uint32_t i = 0; i < call->batch->count && status >= 0; ++i) {
    const odo_header* message = call->batch->messages[i];
    pthread_mutex_lock(&journal.lock);
    note(call, PROBE_GIVEN, message);
    pthread_mutex_unlock(&journal.lock);
    if (hooks.on_message) status = hooks.on_message(call->instance, message);
  }
  return status;
}

int64_t probe_called(probe_call* call) {
  int64_t status = ODO_OK;
  pthread_mutex_lock(&journal.lock);
  note(call, call->what, NULL);
  if (call->instance && call->instance->inside++ > 0) ++journal.overlaps;
  pthread_mutex_unlock(&journal.lock);
  if (call->what == PROBE_PROCESS) status = give(call);
  if (hooks.on_call && status >= 0) status = hooks.on_call(call);
  pthread_mutex_lock(&journal.lock);
  if (call->instance) --call->instance->inside;
  pthread_mutex_unlock(&journal.lock);
  return status;
}

static bool matches(const journal_entry* entry, uint32_t what, const char* kind) {
  return entry->what == what && (!kind || strcmp(entry->kind, kind) == 0);
}

/* The entry `index` of a call and a kind, and of messages of a type unless it is 0; null if there are fewer. `count`,
 * if not null: of all. */
static const journal_entry* find(uint32_t what, const char* kind, uint32_t type, size_t index, size_t* count) {
  const journal_entry* found = NULL;
  size_t seen = 0;
  pthread_mutex_lock(&journal.lock);
  for (size_t i = 0; i < journal.count; ++i) {
    const journal_entry* entry = journal.entries[i];
    if (!matches(entry, what, kind) || (type && entry->message->type != type)) continue;
    if (seen++ == index) found = entry;
  }
  pthread_mutex_unlock(&journal.lock);
  if (count) *count = seen;
  return found;
}

size_t journal_count(uint32_t what, const char* kind) {
  size_t count;
  find(what, kind, 0, 0, &count);
  return count;
}

const journal_entry* journal_find(uint32_t what, const char* kind, size_t index) {
  return find(what, kind, 0, index, NULL);
}

size_t given_count(uint32_t type, const char* kind) {
  size_t count;
  find(PROBE_GIVEN, kind, type, 0, &count);
  return count;
}

const odo_header* given_message(uint32_t type, const char* kind, size_t index) {
  const journal_entry* entry = find(PROBE_GIVEN, kind, type, index, NULL);
  return entry ? entry->message : NULL;
}

unsigned journal_overlaps(void) {
  pthread_mutex_lock(&journal.lock);
  unsigned overlaps = journal.overlaps;
  pthread_mutex_unlock(&journal.lock);
  return overlaps;
}

const char* journal_words(const char* kind) {
  static const char* const names[] = {"entry", "create", "configure", "activate", "process",
                                      "reset", "save",   "load",      "destroy",  "given"};
  static char words[1024];
  size_t used = 0;
  words[0] = 0;
  pthread_mutex_lock(&journal.lock);
  for (size_t i = 0; i < journal.count && used < sizeof words - 16; ++i)
    if (journal.entries[i]->what != PROBE_GIVEN && matches(journal.entries[i], journal.entries[i]->what, kind))
      used +=
          (size_t)snprintf(words + used, sizeof words - used, "%s%s", used ? " " : "", names[journal.entries[i]->what]);
  pthread_mutex_unlock(&journal.lock);
  return words;
}

void journal_clear(void) {
  pthread_mutex_lock(&journal.lock);
  journal.count = 0; /* entries stay valid; their memory is freed at the end of the process */
  journal.overlaps = 0;
  pthread_mutex_unlock(&journal.lock);
}

int32_t probe_emit(odo_instance* instance, const void* event) {
  return instance->sink->emit(instance->sink, (const odo_header*)event);
}
