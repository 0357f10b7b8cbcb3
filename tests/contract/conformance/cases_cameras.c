/* SPDX-License-Identifier: Apache-2.0
 *
 * Several cameras, and cameras whose clock is not the IMU's. */
#include "app.h"

#define SAME_SOURCE "the same for frames and calibration of one camera"
#define SHIFTS \
  "The host applies it: plugins receive frames in IMU time and calibrations without ODO_CALIBRATION_TIME_OFFSET"

static int32_t push_frame(app* self, uint32_t camera, int64_t t_ns) {
  odo_frame frame;
  put_frame(&frame, camera, t_ns);
  return push(self, &frame);
}

static void push_calibration(app* self, uint32_t camera, int64_t offset_ns) {
  odo_calibration calibration;
  put_calibration(&calibration, camera, T0 - SECOND);
  calibration.header.flags = offset_ns ? ODO_CALIBRATION_TIME_OFFSET : 0;
  calibration.time_offset_ns = offset_ns;
  EXPECT(push(self, &calibration), ODO_OK);
}

static size_t frames_of(uint32_t camera, const char* kind) {
  const odo_header* found;
  size_t count = 0;
  for (size_t i = 0; (found = given_message(ODO_TYPE_FRAME, kind, i)) != NULL; ++i) count += found->source == camera;
  return count;
}

static void push_pairs(app* self, uint32_t first, uint32_t second) {
  for (int i = 0; i < 4; ++i) {
    EXPECT(push_frame(self, first, T0 + i * 100 * MS), ODO_OK);
    EXPECT(push_frame(self, second, T0 + i * 100 * MS), ODO_OK);
  }
  app_flush(self);
  EQUAL(app_statistics(self).duplicate, 0);
}

CASE("frames of two cameras may have the same time", "base.h", SAME_SOURCE) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_calibration(self, 0, 0), push_calibration(self, 1, 0);
  push_pairs(self, 0, 1);
  CHECK(frames_of(0, FIXER) == 4 && frames_of(1, FIXER) == 4, "the fixer was given %u and %u frames; expected 4 and 4",
        (unsigned)frames_of(0, FIXER), (unsigned)frames_of(1, FIXER));
  EQUAL(given_count(ODO_TYPE_CALIBRATION, FIXER), 2);
}

static void one_camera_for_a_frontend(int calibrated) {
  app* self = app_open(CONFIG WITH_FRONTEND, ODO_RUN_REPLAY);
  const uint32_t first = calibrated ? 5 : 2; /* of frames at one time, that of the lower source */
  const odo_header* found;
  if (calibrated) push_calibration(self, 5, 0), push_calibration(self, 2, 0);
  push_pairs(self, 5, 2);
  CHECK(frames_of(first, FRONTEND) == 4 && frames_of(7 - first, FRONTEND) == 0,
        "it was given %u frames of the first camera and %u of the second; expected 4 and 0",
        (unsigned)frames_of(first, FRONTEND), (unsigned)frames_of(7 - first, FRONTEND));
  for (size_t i = 0; (found = given_message(ODO_TYPE_CALIBRATION, FRONTEND, i)) != NULL; ++i)
    EQUAL(found->source, first);
}
CASE_OF(one_camera_for_a_frontend, 0, "a front-end is given the first camera that has a frame", "vo_frontend.h",
        "Frames and calibrations are those of the main camera");
CASE_OF(one_camera_for_a_frontend, 1, "a front-end is given one of two calibrated cameras", "vo_frontend.h",
        "Frames and calibrations are those of the main camera");

CASE("a front-end is given the first camera that has a calibration", "vo_frontend.h",
     "Frames and calibrations are those of the main camera") {
  app* self = app_open(CONFIG WITH_FRONTEND, ODO_RUN_REPLAY);
  push_calibration(self, 2, 0);
  push_pairs(self, 5, 2);
  CHECK(frames_of(5, FRONTEND) == 0 && frames_of(2, FRONTEND) == 4,
        "it was given %u frames of a camera without calibration and %u of the calibrated one; expected 0 and 4",
        (unsigned)frames_of(5, FRONTEND), (unsigned)frames_of(2, FRONTEND));
}

CASE("a front-end for several cameras is given all", "plugin.h",
     "the front-end receives frames of all cameras, not only of the main one") {
  app* self = app_open(CONFIG WITH_SEVERAL, ODO_RUN_REPLAY);
  push_calibration(self, 5, 0), push_calibration(self, 2, 0);
  push_pairs(self, 5, 2);
  CHECK(frames_of(5, FRONTEND) == 4 && frames_of(2, FRONTEND) == 4, "it was given %u and %u frames; expected 4 and 4",
        (unsigned)frames_of(5, FRONTEND), (unsigned)frames_of(2, FRONTEND));
  EQUAL(given_count(ODO_TYPE_CALIBRATION, FRONTEND), 2);
}

CASE("a camera's time offset is applied once, by the host", "samples.h", SHIFTS) {
  app* self = app_open(CONFIG WITH_FRONTEND WITH_FIXER, ODO_RUN_REPLAY);
  static const char* const kinds[] = {FRONTEND, FIXER};
  push_calibration(self, 0, 30 * MS);
  FLUSHED(self, push_frame(self, 0, T0));
  for (size_t i = 0; i < COUNT_OF(kinds); ++i) {
    const odo_header* frame = given_message(ODO_TYPE_FRAME, kinds[i], 0);
    const odo_header* calibration = given_message(ODO_TYPE_CALIBRATION, kinds[i], 0);
    REQUIRE(frame && calibration, "%s was not given frame and calibration", kinds[i]);
    CHECK(frame->t_ns == T0 + 30 * MS, "%s was given a frame that is shifted by %lld ns; expected 30 ms", kinds[i],
          (long long)(frame->t_ns - T0));
    CHECK((calibration->flags & ODO_CALIBRATION_TIME_OFFSET) == 0, "%s was given a calibration with flags 0x%x",
          kinds[i], calibration->flags);
  }
}

CASE("a calibration loses its time offset and nothing else", "samples.h", SHIFTS) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_calibration calibration;
  put_calibration(&calibration, 0, T0);
  calibration.header.flags = ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET | ODO_CALIBRATION_LINE_TIME;
  calibration.time_offset_ns = MS, calibration.line_time_ns = 20000;
  FLUSHED(self, push(self, &calibration));
  const odo_header* found = given_message(ODO_TYPE_CALIBRATION, FIXER, 0);
  REQUIRE(found, "the plugin was not given the calibration");
  EQUAL(found->flags, (ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_LINE_TIME));
}

CASE("each camera has a time offset of its own", "samples.h", "IMU time = camera time + time_offset_ns.") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const odo_header* found;
  size_t i;
  push_calibration(self, 0, 20 * MS), push_calibration(self, 1, -10 * MS);
  EXPECT(push_frame(self, 0, T0), ODO_OK);
  EXPECT(push_frame(self, 1, T0), ODO_OK);
  EXPECT(push_frame(self, 2, T0), ODO_OK); /* not calibrated: not shifted */
  app_flush(self);
  for (i = 0; (found = given_message(ODO_TYPE_FRAME, FIXER, i)) != NULL; ++i) {
    static const int64_t shifts[] = {20 * MS, -10 * MS, 0};
    REQUIRE(found->source < COUNT_OF(shifts), "a frame is of camera %u", found->source);
    CHECK(found->t_ns - T0 == shifts[found->source], "a frame of camera %u is shifted by %lld ns", found->source,
          (long long)(found->t_ns - T0));
  }
  EQUAL(i, 3);
}

CASE("a camera's time offset outlives a clock that is set back", "samples.h", SHIFTS) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_calibration(self, 0, 30 * MS);
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  journal_clear();
  push_set_back(self, T0 / 2, T0 / 2 + 3 * SECOND);
  FLUSHED(self, push_frame(self, 0, T0 / 2 + 4 * SECOND));
  const odo_header* found = given_message(ODO_TYPE_CALIBRATION, FIXER, 0);
  CHECK(found && !(found->flags & ODO_CALIBRATION_TIME_OFFSET),
        "the calibration did not come again, or with its offset");
  found = given_message(ODO_TYPE_FRAME, FIXER, 0);
  CHECK(found && found->t_ns == T0 / 2 + 4 * SECOND + 30 * MS, "the frame was not given, or not shifted");
}
