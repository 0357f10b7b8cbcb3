// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <Eigen/Core>

#include "tests/support/runs.hpp"

namespace odograph {

/// A walk of 5 m past a tag, alone in the street.
inline Scenario past_a_tag() {
  Scenario s;
  s.route = {{0, 0, 0}, {5, 0, 0}};
  s.objects = {{8, 0.6, 1.4, 0.5}};
  s.world.pedestrians = 0, s.world.cars = 0;
  s.camera.rate_hz = 4;
  return s;
}

/// Finds the tags in the pictures by AprilTag's own detector. Checks that they are within that distance of where they
/// truly are, more than five of them, and calls a function with the time and first corner of each.
template <class Use>
void check_tags(const Recording& recording, double within_px, Use&& use) {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  detector->quad_decimate = 1;
  size_t index = 0, compared = 0;
  for_each_picture(recording, [&](const odo_frame& frame) {
    const int64_t t_ns = recording.truth[index++].t_ns;
    image_u8_t image{640, 480, static_cast<int32_t>(frame.planes[0].row_stride),
                     const_cast<uint8_t*>(frame.planes[0].data)};
    zarray_t* found = apriltag_detector_detect(detector, &image);
    for (const TrueSighting& sighting : recording.true_sightings) {
      if (sighting.t_ns != t_ns || sighting.visible < 1) continue;
      for (int i = 0; i < zarray_size(found); ++i) {
        apriltag_detection_t* d = nullptr;
        zarray_get(found, i, &d);
        CHECK(d->id == 0);
        ++compared;
        for (size_t k = 0; k < 4; ++k)  // AprilTag's pixel centres are at one half
          CHECK(std::hypot(d->p[k][0] - 0.5 - sighting.corners_px[2 * k],
                           d->p[k][1] - 0.5 - sighting.corners_px[2 * k + 1]) < within_px);
        use(t_ns, Eigen::Vector2d(d->p[0][0] - 0.5, d->p[0][1] - 0.5));
      }
    }
    apriltag_detections_destroy(found);
  });
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  CHECK(compared > 5);
}

}  // namespace odograph
