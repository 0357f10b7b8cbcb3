/* SPDX-License-Identifier: Apache-2.0
 *
 * The suite's plugin: it forwards each call to the suite's own process, which records the calls and answers. It is
 * registered if the library supports that, otherwise loaded from a folder; then it finds the suite by a service of
 * the
 * app. */
#ifndef CONFORMANCE_PROBE_H
#define CONFORMANCE_PROBE_H

#include <odograph/messages.h>
#include <odograph/plugin.h>

/* conformance/probe serves every kind and declares every input and the vendor's messages below; conformance/frontend
 * declares nothing beyond its kind; conformance/several supports several cameras and native frames; all optional items
 * in the table of conformance/bare are null. */
enum probe_variant { PROBE_FULL, PROBE_FRONTEND, PROBE_SEVERAL, PROBE_BARE, PROBE_VARIANTS };

#define PROBE_VENDOR 1u
#define PROBE_MESSAGE ODO_TYPE_VENDOR(PROBE_VENDOR, 1)
#define PROBE_EVENT ODO_TYPE_VENDOR(PROBE_VENDOR, ODO_VENDOR_EVENT | 2)
#define PROBE_UNDECLARED ODO_TYPE_VENDOR(PROBE_VENDOR, 3)
#define PROBE_BORROWED ODO_TYPE_VENDOR(PROBE_VENDOR, ODO_BORROWED | 1)
#define PROBE_BORROWED_UNDECLARED ODO_TYPE_VENDOR(PROBE_VENDOR, ODO_BORROWED | 2)
/* Inputs of a later version. */
#define PROBE_NEWER_INPUT 0x7F0u
#define PROBE_NEWER_BORROWED 0xFF0u
#define PROBE_NEWER_EVENT 0x17F0u

enum probe_what {
  PROBE_ENTRY,
  PROBE_CREATE,
  PROBE_CONFIGURE,
  PROBE_ACTIVATE,
  PROBE_PROCESS,
  PROBE_RESET,
  PROBE_SAVE,
  PROBE_LOAD,
  PROBE_DESTROY,
  PROBE_GIVEN /* one message of a batch */
};

struct odo_instance {
  const odo_host* host;
  const odo_sink* sink; /* null before activate */
  uint32_t number;
  uint32_t inside; /* number of running calls */
  char plugin[40];
  char kind[40];
};

typedef struct probe_call {
  uint32_t what;
  uint32_t count;          /* of values */
  odo_instance* instance;  /* null in the entry */
  const odo_host* host;    /* in the entry */
  const odo_batch* batch;  /* process */
  const odo_value* values; /* configure */
  void* data;              /* save; in the entry the table */
  const void* blob;        /* load */
  uint64_t size;           /* of data or blob; in configure the stride */
} probe_call;

/* Returns a status; for PROBE_SAVE a number of bytes. */
typedef int64_t (*probe_handler)(probe_call* call);

#define PROBE_SERVICE "conformance.suite/1"
typedef struct probe_service {
  uint32_t struct_size;
  uint32_t reserved;
  probe_handler called;
} probe_service;

#if !defined(PROBE_MODULE)
int64_t probe_called(probe_call* call); /* journal.c */
extern const odo_plugin_entry probe_entries[PROBE_VARIANTS];
#endif

#endif
