/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: what every value that crosses the border is made of, and the rules.
 *
 * One message protocol serves live input, recording, replay, plugins and bindings: every sample that goes in and every
 * event that comes out is a struct that starts with an `odo_header`.
 *
 * Rules that hold for every struct here
 *  - It starts with `uint32_t struct_size`, the size its writer knew. Fields are only ever appended; a reader asks
 *    ODO_HAS(pointer, field) before it touches a field that did not exist in version 1.0 (the sizes of which are in
 *    messages.h). What is smaller than version 1.0 is refused, what is larger than the reader's struct is passed on whole.
 *  - No pointer is ever appended to a message: who passes it on need not understand it.
 *  - A number out of a list (a mode, a reason, a state, a format) may be newer than its reader: docs/abi.md says for each
 *    list what an unknown one counts as.
 *  - Fixed-width integers, float, double and pointers only; padding is explicit and zero; layout.h pins every offset.
 *  - A value is valid when its bit in `header.flags` says so, never by being or not being NaN.
 *  - SI units and radians. Time is int64_t nanoseconds of the sensor clock (any epoch, one clock for all sensors).
 *  - Frames: n = local North-East-Down, b = body (the IMU's axes), c = camera (x right, y down, z forward).
 *    R_n_c takes vectors from c to n, p_n_c is the camera's position in n.
 *  - Quaternions are Hamilton, stored w, x, y, z: q_n_b rotates vectors from b to n. Matrices are row-major.
 */
#ifndef ODOGRAPH_BASE_H
#define ODOGRAPH_BASE_H

#include <stddef.h>
#include <stdint.h>

/* One layout for all: pointers of 8 bytes, everything aligned to its own size. */
#if UINTPTR_MAX != UINT64_MAX
#error "Odograph's ABI is for 64-bit targets: a struct with pointers would be laid out otherwise here"
#endif

/* How functions are called across the border. Windows compilers may be told to use another convention by default. */
#if defined(_WIN32)
#define ODO_CALL __cdecl
#else
#define ODO_CALL
#endif

/* ODO_EXPORT: what a plugin exports, its entry. ODO_API: what the library exports and an app imports. */
#if defined(_WIN32)
#define ODO_EXPORT __declspec(dllexport)
#if defined(ODO_BUILDING_LIBRARY)
#define ODO_API __declspec(dllexport)
#else
#define ODO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define ODO_EXPORT __attribute__((visibility("default")))
#define ODO_API ODO_EXPORT
#else
#define ODO_EXPORT
#define ODO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The ABI spoken by these headers. A break raises the major and renames the entry symbol; an addition raises the minor.
 * Major 0 is a draft: host and plugin must be of the same draft, which is the minor. The freeze makes it 1.0. */
#define ODO_ABI_MAJOR UINT32_C(0)
#define ODO_ABI_MINOR UINT32_C(2)

/* True when the struct behind `ptr` is large enough to hold `field`. Its first member is, by rule, its size. */
#define ODO_HAS(ptr, field)                                                                                            \
  ((uint64_t)((const char *)&(ptr)->field - (const char *)(ptr)) + sizeof((ptr)->field) <=                             \
   (uint64_t) * (const uint32_t *)(const void *)(ptr))

/* ---- status codes -------------------------------------------------------------------------------------------------
 * Zero is success. Each failure has a stated effect on the instance that returned it. */
#define ODO_OK 0
#define ODO_NOT_READY 1         /* no output yet; nothing is wrong and the state is as it was */
#define ODO_E_ARGUMENT (-1)     /* the caller broke the contract; discarded, state unchanged */
#define ODO_E_DISCARD (-2)      /* the input was unusable; discarded, state unchanged */
#define ODO_E_EXHAUSTED (-3)    /* a quota or a buffer is used up; discarded, state unchanged */
#define ODO_E_UNSUPPORTED (-4)  /* not offered by this side; state unchanged */
#define ODO_E_STRUCT_SIZE (-5)  /* a struct is smaller than version 1.0 of it; state unchanged */
#define ODO_E_VERSION (-6)      /* no common ABI version; nothing was created */
#define ODO_E_STATE (-7)        /* called in the wrong state; state unchanged */
#define ODO_E_CONFIG (-8)       /* configuration refused; the instance stays unconfigured */
#define ODO_E_NOT_FOUND (-9)    /* no such file, plugin, key or time; state unchanged */
#define ODO_E_DATA (-10)        /* a file or blob is damaged; state unchanged */
#define ODO_E_MEMORY (-11)      /* out of memory; the instance needs reset or load */
#define ODO_E_ERROR (-12)       /* the instance needs reset or load before it works again */
#define ODO_E_FATAL (-13)       /* the whole library is quarantined */

/* A UTF-8 string that is not terminated and not owned. Frozen at 16 bytes; embedded by value in other structs. */
typedef struct odo_string {
  const char *data; /* may be null when size is 0 */
  uint64_t size;    /* bytes */
} odo_string;

/* ---- messages ----------------------------------------------------------------------------------------------------- */
/* Numbers by range: 0 is none, 0x1 to 0xFFF are inputs, 0x1000 to 0x1FFF events, up to 0x7FFFFFFF reserved, and the upper
 * half belongs to vendors. What a host does not know and is not an event, it takes, puts into order, records and hands to
 * the plugins that declare it. */
#define ODO_TYPE_IMU UINT32_C(0x1)
#define ODO_TYPE_MAGNETOMETER UINT32_C(0x2)
#define ODO_TYPE_BAROMETER UINT32_C(0x3)
#define ODO_TYPE_GNSS UINT32_C(0x4)
#define ODO_TYPE_FRAME UINT32_C(0x5)
#define ODO_TYPE_CALIBRATION UINT32_C(0x6)
#define ODO_TYPE_IMU_NOISE UINT32_C(0x7)
#define ODO_TYPE_WAYPOINT UINT32_C(0x8)
#define ODO_TYPE_ATTITUDE UINT32_C(0x1001)
#define ODO_TYPE_STEP UINT32_C(0x1002)
#define ODO_TYPE_MOTION_MODE UINT32_C(0x1003)
#define ODO_TYPE_VO_MOTION UINT32_C(0x1004)
#define ODO_TYPE_SCALE UINT32_C(0x1005)
#define ODO_TYPE_FIX UINT32_C(0x1006)
#define ODO_TYPE_POSE UINT32_C(0x1007)
#define ODO_TYPE_STATE UINT32_C(0x1008)
#define ODO_TYPE_CORRECTION UINT32_C(0x1009)
#define ODO_TYPE_REPORT UINT32_C(0x100A)

/* A vendor's own message: `vendor` (below 2^19) as docs/abi.md says, `number` (below 4096) as the vendor likes. It starts
 * with an odo_header, has at most ODO_LARGEST_MESSAGE bytes and no pointer: it is copied, recorded and replayed. Vendor 0
 * is for experiments. */
#define ODO_TYPE_VENDOR(vendor, number)                                                                                \
  (UINT32_C(0x80000000) | ((uint32_t)(vendor) & UINT32_C(0x7FFFF)) << 12 | ((uint32_t)(number) & UINT32_C(0xFFF)))
#define ODO_IS_EVENT(type) (((uint32_t)(type) >> 12) == 1)
#define ODO_IS_VENDOR(type) (((uint32_t)(type) >> 31) == 1)
#define ODO_LARGEST_MESSAGE UINT32_C(65536)

/* The head of every message. Frozen at 32 bytes; a message grows at its end. */
typedef struct odo_header {
  uint32_t struct_size; /* bytes of the whole message, as its writer knew it */
  uint32_t type;        /* ODO_TYPE_* */
  int64_t t_ns;         /* time the message is valid for; for a frame the middle of the exposure of the middle row */
  uint32_t source;      /* who made it: sensor index on input; on events the instance number, filled in by the host */
  uint32_t flags;       /* validity bits of this type */
  float quality;        /* 0 (worthless) to 1 (as good as it gets); 0 also where the writer does not say */
  uint32_t reserved;    /* 0 */
} odo_header;

#ifdef __cplusplus
}
#endif
#endif
