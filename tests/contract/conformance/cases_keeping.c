/* SPDX-License-Identifier: Apache-2.0
 *
 * Frames as plugin inputs: retained frames, copied and borrowed pixels, native memory. */
#include "app.h"

#include <string.h>

static uint8_t pixels[64 * 48];

/* The plugin's handling of frames. */
static struct {
  odo_frame kept[16];
  int count, refused, max;
  int at_destroy; /* released in destroy, not before */
  const uint8_t* data;
  uint8_t first_pixel;
  const void* native;
  int shown;
} plugin;

static void release_all(void) {
  while (plugin.count > 0) {
    odo_frame* oldest = &plugin.kept[--plugin.count];
    oldest->loan.release(oldest->loan.owner);
  }
}

static int32_t look_and_keep(odo_instance* instance, const odo_header* message) {
  const odo_frame* frame = (const odo_frame*)(const void*)message;
  if (message->type != ODO_TYPE_FRAME) return ODO_OK;
  ++plugin.shown;
  plugin.data = frame->planes[0].data;
  plugin.first_pixel = plugin.data ? plugin.data[0] : 0;
  if (frame->loan.native)
    plugin.native =
        frame->loan.native(frame->loan.owner, ODO_NATIVE_HARDWARE_BUFFER, sizeof ODO_NATIVE_HARDWARE_BUFFER - 1);
  if (plugin.count >= plugin.max) return ODO_OK;
  if (!frame->loan.retain || frame->loan.retain(frame->loan.owner) < 0)
    ++plugin.refused;
  else
    odo_copy(&plugin.kept[plugin.count++], sizeof(odo_frame), message);
  return ODO_OK;
}

static int64_t release_at_destroy(probe_call* call) {
  if (call->what == PROBE_DESTROY && plugin.at_destroy) release_all();
  return ODO_OK;
}

static app* open_keeping(const char* config, int max) {
  plugin.max = max;
  hooks.on_message = look_and_keep;
  hooks.on_call = release_at_destroy;
  return app_open(config, ODO_RUN_REPLAY);
}

static void push_lent(app* self, lent* memory, int64_t t_ns) {
  odo_frame frame;
  put_frame(&frame, 0, t_ns);
  frame.planes[0].data = pixels;
  lend(&frame.loan, memory);
  EXPECT(push(self, &frame), ODO_OK);
  memset(&frame, 0xFF, sizeof frame);
}

static void kept_until_released(int unused) {
  app* self = open_keeping(FIXER_ALONE, 3);
  lent memory = NOT_LENT;
  for (int i = 0; i < 3; ++i) push_lent(self, &memory, T0 + i * 100 * MS);
  app_flush(self);
  CHECK(plugin.count == 3, "the plugin could retain %d of 3 frames", plugin.count);
  CHECK(memory.retains - memory.releases == 3, "%d frames are retained; expected 3", memory.retains - memory.releases);
  release_all();
  CHECK_BALANCED(&memory, 3);
}

static void kept_until_destroy(int unused) {
  app* self = open_keeping(FIXER_ALONE, 3);
  lent memory = NOT_LENT;
  plugin.at_destroy = 1;
  for (int i = 0; i < 5; ++i) push_lent(self, &memory, T0 + i * 100 * MS);
  app_close(self);
  CHECK_BALANCED(&memory, 3);
}

static void many_kept(int unused) {
  app* self = open_keeping(FIXER_ALONE "time_ordering:\n  frames: 8\n", 16);
  lent memory = NOT_LENT;
  int refused = 0;
  for (int i = 0; i < 12; ++i) {
    odo_frame frame;
    put_frame(&frame, 0, T0 + i * 100 * MS);
    frame.planes[0].data = pixels;
    lend(&frame.loan, &memory);
    refused += push(self, &frame) == ODO_E_EXHAUSTED;
    app_flush(self);
  }
  CHECK(plugin.refused + refused > 0, "12 frames could be retained where 8 may be");
  CHECK(plugin.count >= 1 && plugin.count <= 8, "the plugin retains %d frames; 8 may be", plugin.count);
  release_all();
  push_lent(self, &memory, T0 + 2 * SECOND);
  app_flush(self);
  release_all();
  CHECK_BALANCED(&memory, 1);
}

static void not_copied(int unused) {
  app* self = open_keeping(FIXER_ALONE, 0);
  lent memory = NOT_LENT;
  push_lent(self, &memory, T0);
  app_flush(self);
  CHECK(plugin.data == pixels, "the plugin was given a copy of the pixels");
}

static void copied_without_retain(int which) {
  app* self = open_keeping(FIXER_ALONE, which == 2 ? 1 : 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_frame(&frame, 0, T0);
  frame.planes[0].data = pixels;
  if (which == 1) lend(&frame.loan, &memory), frame.loan.retain = NULL;
  pixels[0] = 17;
  EXPECT(push(self, &frame), ODO_OK);
  pixels[0] = 99;
  app_flush(self);
  CHECK(plugin.shown == 1 && plugin.first_pixel == 17, "the plugin saw pixel %u; expected 17", plugin.first_pixel);
  CHECK(memory.releases == 0, "release was called without retain");
  if (which != 2) return;
  CHECK(plugin.count == 1, "the plugin could not retain a frame that the host copied");
  if (plugin.count == 1) CHECK(plugin.kept[0].planes[0].data[0] == 17, "the retained pixels changed");
  release_all();
}

static void native_passes(int unused) {
  app* self = open_keeping(FIXER_ALONE, 0);
  lent memory = NOT_LENT;
  memory.native = &memory;
  push_lent(self, &memory, T0);
  app_flush(self);
  CHECK(plugin.native == &memory, "the plugin got %p; expected %p", (void*)(uintptr_t)plugin.native, (void*)&memory);
  CHECK_BALANCED(&memory, 1);
}

static void native_alone(int declares) {
  app* self = open_keeping(declares ? CONFIG WITH_SEVERAL : CONFIG WITH_FRONTEND, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  memory.native = &memory;
  put_frame(&frame, 0, T0);
  frame.planes[0].data = NULL;
  lend(&frame.loan, &memory);
  EXPECT(push(self, &frame), ODO_OK);
  app_flush(self);
  CHECK(plugin.shown == (declares ? 1 : 0), "the front-end was given %d frames; expected %d", plugin.shown,
        declares ? 1 : 0);
  if (declares) CHECK(plugin.native == &memory && !plugin.data, "its native memory was not given on");
  CHECK_BALANCED(&memory, 0);
}

static void later_end_of_a_frame(int unused) {
  struct {
    odo_frame frame;
    unsigned char end[40];
  } larger;
  app* self = open_keeping(FIXER_ALONE, 0);
  memset(&larger, 0x5A, sizeof larger);
  put_frame(&larger.frame, 0, T0);
  larger.frame.header.struct_size = sizeof larger;
  larger.frame.header.flags = ODO_FLAG_HOST_MASK | 0x00800000u;
  EXPECT(push(self, &larger), ODO_OK);
  app_flush(self);
  const odo_header* found = given_message(ODO_TYPE_FRAME, FIXER, 0);
  REQUIRE(found, "the plugin was not given the frame");
  CHECK(found->flags == 0x00800000u, "it was given with flags 0x%x", found->flags);
  REQUIRE(found->struct_size == sizeof larger, "it was given with %u bytes; expected %u", found->struct_size,
          (unsigned)sizeof larger);
  CHECK(memcmp((const unsigned char*)found + sizeof larger.frame, larger.end, sizeof larger.end) == 0,
        "its end is another");
}

static void frame_too_small(int unused) {
  app* self = open_keeping(FIXER_ALONE, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_frame(&frame, 0, T0);
  lend(&frame.loan, &memory);
  frame.header.struct_size = ODO_FRAME_SIZE_MIN - 1;
  EXPECT(push(self, &frame), ODO_E_STRUCT_SIZE);
  CHECK_BALANCED(&memory, 0);
}

static void unknown_format(int unused) {
  app* self = open_keeping(FIXER_ALONE, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_frame(&frame, 0, T0);
  frame.format = 77;
  frame.plane_count = 1;
  frame.planes[0].rows = 48;
  lend(&frame.loan, &memory);
  EXPECT(push(self, &frame), ODO_OK);
  app_flush(self);
  CHECK(plugin.shown == 1, "the plugin was not given a frame of an unknown format");
  CHECK_BALANCED(&memory, 1);
}

const conformance_case cases_keeping[] = {
    {"frames that a plugin retains are released when it releases them", "base.h", "later release, once for each retain",
     kept_until_released, 0},
    {"frames that a plugin releases as it is destroyed are released once", "base.h",
     "later release, once for each retain", kept_until_destroy, 0},
    {"a plugin that retains too many frames is refused and nothing is lost", "base.h",
     "ODO_E_EXHAUSTED if too many are retained", many_kept, 0},
    {"pixels are not copied where the frame has retain and release", "odograph.h",
     "The pixels of a frame are not copied if it has retain and release", not_copied, 0},
    {"pixels are copied where the frame has neither retain nor release", "odograph.h", "otherwise they are copied once",
     copied_without_retain, 0},
    {"pixels are copied where the frame cannot be retained", "base.h", "null: cannot be retained",
     copied_without_retain, 1},
    {"a plugin can retain a frame whose pixels the host copied", "base.h", "To use it longer, call retain",
     copied_without_retain, 2},
    {"native memory is given on to plugins", "base.h", "Returns the platform object (ODO_NATIVE_*), borrowed likewise",
     native_passes, 0},
    {"a frame with native memory alone reaches a plugin that declares it", "plugin.h",
     "the plugin accepts frames whose pixels are available from loan.native only", native_alone, 1},
    {"a frame with native memory alone is kept from other plugins", "plugin.h",
     "the plugin accepts frames whose pixels are available from loan.native only", native_alone, 0},
    {"the end of a later odo_frame is passed on, the host's bits are cleared", "base.h",
     "Of a larger one, the part beyond the known fields is forwarded unread.", later_end_of_a_frame, 0},
    {"odo_frame that is too small is refused", "base.h", "A struct smaller than in version 1.0 is rejected.",
     frame_too_small, 0},
    {"a frame of an unknown format is passed on", "samples.h",
     "A format unknown to the host is forwarded; if the frame cannot be retained, its planes are copied",
     unknown_format, 0},
    {NULL, NULL, NULL, NULL, 0}};
