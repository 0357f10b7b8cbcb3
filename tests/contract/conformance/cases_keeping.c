/* SPDX-License-Identifier: Apache-2.0
 *
 * Frames as plugin inputs: retained frames, copied and borrowed pixels, native memory. */
#include "app.h"

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

CASE("frames that a plugin retains are released when it releases them", "base.h",
     "later release, once for each retain") {
  app* self = open_keeping(FIXER_ALONE, 3);
  lent memory = NOT_LENT;
  for (int i = 0; i < 3; ++i) EXPECT(push_lent(self, &memory, T0 + i * 100 * MS), ODO_OK);
  app_flush(self);
  EQUAL(plugin.count, 3);
  EQUAL(memory.retains - memory.releases, 3);
  release_all();
  CHECK_BALANCED(&memory, 3);
}

CASE("frames that a plugin releases as it is destroyed are released once", "base.h",
     "later release, once for each retain") {
  app* self = open_keeping(FIXER_ALONE, 3);
  lent memory = NOT_LENT;
  plugin.at_destroy = 1;
  for (int i = 0; i < 5; ++i) EXPECT(push_lent(self, &memory, T0 + i * 100 * MS), ODO_OK);
  app_close(self);
  CHECK_BALANCED(&memory, 3);
}

CASE("a plugin that retains too many frames is refused and nothing is lost", "base.h",
     "ODO_E_EXHAUSTED if too many are retained") {
  app* self = open_keeping(FIXER_ALONE "time_ordering:\n  frames: 8\n", 16);
  lent memory = NOT_LENT;
  int refused = 0;
  for (int i = 0; i < 12; ++i) {
    odo_frame frame;
    put_lent_frame(&frame, &memory, T0 + i * 100 * MS);
    refused += push(self, &frame) == ODO_E_EXHAUSTED;
    app_flush(self);
  }
  CHECK(plugin.refused + refused > 0, "12 frames could be retained where 8 may be");
  CHECK(plugin.count >= 1 && plugin.count <= 8, "the plugin retains %d frames; 8 may be", plugin.count);
  release_all();
  FLUSHED(self, push_lent(self, &memory, T0 + 2 * SECOND));
  release_all();
  CHECK_BALANCED(&memory, 1);
}

CASE("pixels are not copied where the frame has retain and release", "odograph.h",
     "The pixels of a frame are not copied if it has retain and release") {
  app* self = open_keeping(FIXER_ALONE, 0);
  lent memory = NOT_LENT;
  FLUSHED(self, push_lent(self, &memory, T0));
  CHECK(plugin.data == lent_pixels, "the plugin was given a copy of the pixels");
}

static void copied_without_retain(int which) {
  app* self = open_keeping(FIXER_ALONE, which == 2 ? 1 : 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_frame(&frame, 0, T0);
  frame.planes[0].data = lent_pixels;
  if (which == 1) lend(&frame.loan, &memory), frame.loan.retain = NULL;
  lent_pixels[0] = 17;
  EXPECT(push(self, &frame), ODO_OK);
  lent_pixels[0] = 99;
  app_flush(self);
  CHECK(plugin.shown == 1 && plugin.first_pixel == 17, "the plugin saw pixel %u; expected 17", plugin.first_pixel);
  CHECK(memory.releases == 0, "release was called without retain");
  if (which != 2) return;
  CHECK(plugin.count == 1, "the plugin could not retain a frame that the host copied");
  if (plugin.count == 1) CHECK(plugin.kept[0].planes[0].data[0] == 17, "the retained pixels changed");
  release_all();
}
CASE_OF(copied_without_retain, 0, "pixels are copied where the frame has neither retain nor release", "odograph.h",
        "otherwise they are copied once");
CASE_OF(copied_without_retain, 1, "pixels are copied where the frame cannot be retained", "base.h",
        "null: cannot be retained");
CASE_OF(copied_without_retain, 2, "a plugin can retain a frame whose pixels the host copied", "base.h",
        "To use it longer, call retain");

CASE("native memory is given on to plugins", "base.h",
     "Returns the platform object (ODO_NATIVE_*), borrowed likewise") {
  app* self = open_keeping(FIXER_ALONE, 0);
  lent memory = NOT_LENT;
  memory.native = &memory;
  FLUSHED(self, push_lent(self, &memory, T0));
  CHECK(plugin.native == &memory, "the plugin got %p; expected %p", (void*)(uintptr_t)plugin.native, (void*)&memory);
  CHECK_BALANCED(&memory, 1);
}

static void native_alone(int declares) {
  app* self = open_keeping(declares ? CONFIG WITH_SEVERAL : CONFIG WITH_FRONTEND, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  memory.native = &memory;
  put_lent_frame(&frame, &memory, T0);
  frame.planes[0].data = NULL;
  FLUSHED(self, push(self, &frame));
  CHECK(plugin.shown == (declares ? 1 : 0), "the front-end was given %d frames; expected %d", plugin.shown,
        declares ? 1 : 0);
  if (declares) CHECK(plugin.native == &memory && !plugin.data, "its native memory was not given on");
  CHECK_BALANCED(&memory, 0);
}
CASE_OF(native_alone, 1, "a frame with native memory alone reaches a plugin that declares it", "plugin.h",
        "the plugin accepts frames whose pixels are available from loan.native only");
CASE_OF(native_alone, 0, "a frame with native memory alone is kept from other plugins", "plugin.h",
        "the plugin accepts frames whose pixels are available from loan.native only");

CASE("the end of a later odo_frame is passed on, the host's bits are cleared", "base.h",
     "Of a larger one, the part beyond the known fields is forwarded unread.") {
  struct {
    odo_frame frame;
    unsigned char end[40];
  } larger;
  app* self = open_keeping(FIXER_ALONE, 0);
  memset(&larger, 0x5A, sizeof larger);
  put_frame(&larger.frame, 0, T0);
  larger.frame.header.struct_size = sizeof larger;
  larger.frame.header.flags = ODO_FLAG_HOST_MASK | 0x00800000u;
  FLUSHED(self, push(self, &larger));
  const odo_header* found = given_message(ODO_TYPE_FRAME, FIXER, 0);
  REQUIRE(found, "the plugin was not given the frame");
  EQUAL(found->flags, 0x00800000u);
  REQUIRE(found->struct_size == sizeof larger, "it was given with %u bytes; expected %u", found->struct_size,
          (unsigned)sizeof larger);
  CHECK(memcmp((const unsigned char*)found + sizeof larger.frame, larger.end, sizeof larger.end) == 0,
        "its end is another");
}

CASE("odo_frame that is too small is refused", "base.h", "A struct smaller than in version 1.0 is rejected.") {
  app* self = open_keeping(FIXER_ALONE, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_lent_frame(&frame, &memory, T0);
  frame.header.struct_size = ODO_FRAME_SIZE_MIN - 1;
  EXPECT(push(self, &frame), ODO_E_STRUCT_SIZE);
  CHECK_BALANCED(&memory, 0);
}

CASE("a frame of an unknown format is passed on", "samples.h",
     "A format unknown to the host is forwarded; if the frame cannot be retained, its planes are copied") {
  app* self = open_keeping(FIXER_ALONE, 0);
  odo_frame frame;
  lent memory = NOT_LENT;
  put_lent_frame(&frame, &memory, T0);
  frame.format = 77;
  frame.plane_count = 1;
  frame.planes[0].rows = 48;
  FLUSHED(self, push(self, &frame));
  CHECK(plugin.shown == 1, "the plugin was not given a frame of an unknown format");
  CHECK_BALANCED(&memory, 1);
}
