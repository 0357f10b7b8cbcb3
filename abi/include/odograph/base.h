/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: the building blocks of every value that crosses the border, and the rules.
 *
 * One message protocol serves live input, recording, replay, plugins and bindings: every sample that goes in and every
 * event that comes out is a struct that starts with an `odo_header`.
 *
 * Rules for every struct
 *  - It starts with `uint32_t struct_size`. Where a struct is input, that is the number of bytes its writer filled. Where a
 *    struct is output, it is the capacity on entry and the number of bytes written on return.
 *  - Fields are only ever appended; a reader tests ODO_HAS(pointer, field) before it reads a field that version 1.0 did not
 *    have (messages.h has the sizes of 1.0). A struct smaller than version 1.0 is refused; the end of a larger one is passed
 *    on unread.
 *  - No pointer is ever appended to a message, so that a host can forward a message it does not understand. Memory is lent
 *    through `odo_loan` alone.
 *  - A value is valid when its bit in `header.flags` is set, never by being or not being NaN. Each covariance, standard
 *    deviation, quality and integrity either has a bit or is always valid, as its comment states.
 *  - Numbers of a list (modes, reasons, states, formats) may be newer than their reader: docs/abi.md states for each list
 *    what an unknown number means.
 *  - Fixed-width integers, float, double and pointers only. Pointers occupy 8 bytes on every target (ODO_POINTER), padding
 *    is explicit and zero, so that 32-bit and 64-bit targets have one layout; layout.h checks every offset.
 *
 * Conventions
 *  - SI units and radians. Time is int64_t nanoseconds of the sensor clock (any epoch, one clock for all sensors).
 *  - Frames of reference: n = local North-East-Down, whose north is true (geographic) north; b = body, the axes of the IMU;
 *    c = camera, x right, y down, z forward. R_n_c takes vectors from c to n; p_n_c is the position of c's origin in n.
 *    Until something observes north, n's north is arbitrary: ODO_POSE_NORTH and ODO_ATTITUDE_TRUE_NORTH state when it is not.
 *  - Quaternions are Hamilton, stored w, x, y, z: q_n_b rotates vectors from b to n. Matrices are row-major.
 *  - Uncertainty of a rotation is a left perturbation in the target frame: R_true = Exp(theta) R with theta ~ N(0, P), for
 *    q_n_b expressed in n. Covariances are symmetric and positive semidefinite, standard deviations positive.
 */
#ifndef ODOGRAPH_BASE_H
#define ODOGRAPH_BASE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Odograph's ABI is little-endian: recordings and saved state could not be exchanged with this target"
#endif

/* How functions are called across the border: some compilers for Windows can default to another convention. */
#if defined(_WIN32)
#define ODO_CALL __cdecl
#else
#define ODO_CALL
#endif

/* A pointer, and a pointer to a function, as a member: 8 bytes on every target. On 32-bit targets the upper four bytes have
 * no meaning. */
#if UINTPTR_MAX == UINT64_MAX
#define ODO_POINTER(type, name) type name
#define ODO_FUNCTION(result, name, arguments) result(ODO_CALL *name) arguments
#elif UINTPTR_MAX == UINT32_MAX
#if defined(__GNUC__)
#define ODO_ANONYMOUS_UNION __extension__ union
#else
#define ODO_ANONYMOUS_UNION union
#endif
#define ODO_POINTER(type, name)                                                                                        \
  ODO_ANONYMOUS_UNION {                                                                                                \
    type name;                                                                                                         \
    uint64_t name##_bits;                                                                                              \
  }
#define ODO_FUNCTION(result, name, arguments)                                                                          \
  ODO_ANONYMOUS_UNION {                                                                                                \
    result(ODO_CALL *name) arguments;                                                                                  \
    uint64_t name##_bits;                                                                                              \
  }
#else
#error "Odograph's ABI needs pointers of 32 or 64 bits"
#endif

/* ODO_EXPORT: what a plugin exports, its entry. ODO_API: what the library exports and an app imports. Define ODO_STATIC
 * where plugins or the library are linked into the program instead of loaded. */
#if defined(ODO_STATIC)
#define ODO_EXPORT
#define ODO_API
#elif defined(_WIN32)
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

/* The ABI of these headers. A break raises the major and renames the entry symbol; an addition raises the minor. Major 0 is
 * a draft: host and plugin must be of the same draft, which is the minor. The freeze makes it 1.0. */
#define ODO_ABI_MAJOR 0u
#define ODO_ABI_MINOR 3u

/* True when the struct behind `ptr` is large enough to hold `field`. Its first member is, by rule, its size. */
#define ODO_HAS(ptr, field)                                                                                            \
  ((uint64_t)((const char *)&(ptr)->field - (const char *)(ptr)) + sizeof((ptr)->field) <=                             \
   (uint64_t) * (const uint32_t *)(const void *)(ptr))

/* ---- status codes -------------------------------------------------------------------------------------------------
 * Zero is success. Each failure has a stated effect on the instance that returned it. */
#define ODO_OK 0
#define ODO_NOT_READY 1         /* no output yet; nothing is wrong and the state is unchanged */
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
  ODO_POINTER(const char *, data); /* may be null when size is 0 */
  uint64_t size;                   /* bytes */
} odo_string;

/* ---- messages ----------------------------------------------------------------------------------------------------- */
/* Numbers by range: 0 is none, 0x1 to 0xFFF are inputs, 0x1000 to 0x1FFF events, 0x2000 to 0x7FFFFFFF reserved (no app,
 * plugin or recording may use them), and the upper half belongs to vendors. An input or a vendor's message that a host does
 * not know is ordered by time, recorded and given to the plugins that declare it. In every range the bit ODO_BORROWED marks
 * messages that lend memory; they are inputs alone, and emit answers ODO_E_UNSUPPORTED. */
#define ODO_BORROWED 0x800u
#define ODO_TYPE_IMU 0x1u
#define ODO_TYPE_MAGNETOMETER 0x2u
#define ODO_TYPE_BAROMETER 0x3u
#define ODO_TYPE_GNSS 0x4u
#define ODO_TYPE_CALIBRATION 0x5u
#define ODO_TYPE_IMU_NOISE 0x6u
#define ODO_TYPE_WAYPOINT 0x7u
#define ODO_TYPE_EARTH_FIELD 0x8u
#define ODO_TYPE_PLATFORM_POSE 0x9u
#define ODO_TYPE_RANGE 0xAu
#define ODO_TYPE_SYSTEM_STEP 0xBu
#define ODO_TYPE_FRAME 0x801u
#define ODO_TYPE_ATTITUDE 0x1001u
#define ODO_TYPE_STEP 0x1002u
#define ODO_TYPE_MOTION_MODE 0x1003u
#define ODO_TYPE_VO_MOTION 0x1004u
#define ODO_TYPE_SCALE 0x1005u
#define ODO_TYPE_FIX 0x1006u
#define ODO_TYPE_POSE 0x1007u
#define ODO_TYPE_STATE 0x1008u
#define ODO_TYPE_CORRECTION 0x1009u
#define ODO_TYPE_REPORT 0x100Au
#define ODO_TYPE_REFINED 0x100Bu
#define ODO_TYPE_RELATIVE_POSE 0x100Cu

/* A vendor's own message: `vendor` (below 2^19) is assigned in docs/abi.md, `number` (below 4096) is the vendor's choice. It
 * starts with an odo_header and has at most ODO_LARGEST_MESSAGE bytes. With number & ODO_BORROWED it starts with an
 * odo_borrowed; otherwise it has no pointer: it is copied, recorded and replayed. Vendor 0 is for experiments. */
#define ODO_TYPE_VENDOR(vendor, number)                                                                                \
  (0x80000000u | ((uint32_t)(vendor) & 0x7FFFFu) << 12 | ((uint32_t)(number) & 0xFFFu))
#define ODO_IS_EVENT(type) (((uint32_t)(type) >> 12) == 1)
#define ODO_IS_VENDOR(type) (((uint32_t)(type) >> 31) == 1)
#define ODO_IS_RESERVED(type) ((uint32_t)(type) == 0 || ((uint32_t)(type) >= 0x2000u && (uint32_t)(type) <= 0x7FFFFFFFu))
#define ODO_IS_BORROWED(type) (((uint32_t)(type) & ODO_BORROWED) != 0)
#define ODO_LARGEST_MESSAGE 65536u

/* Bits of header.flags: 0 to 23 have a meaning of their own in each type, 24 to 27 are set by the host alone (it clears them
 * on everything it receives, also those it has no meaning for), 28 to 31 are common to all types (28 to 30 are not in use). */
#define ODO_FLAG_QUALITY 0x80000000u   /* header.quality is valid */
#define ODO_FLAG_HOST_MASK 0x0F000000u
#define ODO_FLAG_ACCEPTED 0x01000000u  /* on a published fix or scale: the host used it */
#define ODO_FLAG_NAVIGATION 0x02000000u /* on a motion: q_n_c0 is valid */

/* The head of every message. Frozen at 32 bytes; a message grows at its end. */
typedef struct odo_header {
  uint32_t struct_size; /* bytes of the whole message, as its writer knew it */
  uint32_t type;        /* ODO_TYPE_* */
  int64_t t_ns;         /* time the message is valid for; for a frame the middle of the exposure of the middle row */
  uint32_t source;      /* of an input the sensor's number: frames and calibration of one camera have the same; of an event
                         * the instance number, filled in by the host */
  uint32_t flags;       /* validity bits */
  float quality;        /* 0 (worthless) to 1 (as good as it gets); valid with ODO_FLAG_QUALITY */
  uint32_t reserved;    /* 0 */
} odo_header;

/* Memory that a message lends: pixels, a buffer of the operating system, a texture. It belongs to whoever made the message
 * and is lent for the duration of the call. To use it longer, call retain (ODO_E_EXHAUSTED when too many are retained) and
 * later release, once for each retain; keep a copy of the struct (odo_copy) meanwhile. The functions read `owner` and
 * nothing else, so that a host can retain a message of a type it does not know. Frozen at 40 bytes. */
typedef struct odo_loan {
  ODO_POINTER(void *, owner);                    /* for the functions below alone */
  ODO_FUNCTION(int32_t, retain, (void *owner));  /* [any] null: cannot be retained */
  ODO_FUNCTION(void, release, (void *owner));    /* [any] */
  /* [any] The memory as the platform has it (ODO_NATIVE_*), borrowed like the rest; null where there is none. May be null. */
  ODO_FUNCTION(const void *, native, (void *owner, const char *id, uint64_t id_size));
  uint64_t reserved; /* 0 */
} odo_loan;

/* What `native` answers to each id. */
#define ODO_NATIVE_HARDWARE_BUFFER "android.hardware_buffer/1" /* AHardwareBuffer * */
#define ODO_NATIVE_PIXEL_BUFFER "apple.pixel_buffer/1"         /* CVPixelBufferRef */

/* The head of every message whose type has the bit ODO_BORROWED. Frozen at 72 bytes. */
typedef struct odo_borrowed {
  odo_header header;
  odo_loan loan;
} odo_borrowed;

struct odo_host;   /* plugin.h */
struct odo_plugin;
/* The entry of a plugin. Fills *out up to out->struct_size bytes and returns ODO_OK, or sets out->refusal and returns ODO_E_VERSION or
 * another status. [any] It is called once for each session or tool that uses the plugin, also from several threads at once:
 * it is quick, has no side effects and fills the same table each time. What the table points to is valid for as long as the
 * library is loaded, which is until the process ends. */
typedef int32_t (ODO_CALL *odo_plugin_entry)(const struct odo_host *host, struct odo_plugin *out);

#ifdef __cplusplus
}
#endif
#endif
