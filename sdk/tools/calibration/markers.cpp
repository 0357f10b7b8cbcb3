// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/calibration/markers.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>

namespace odograph {

MarkerFamily::MarkerFamily(const std::string& name) : name_(name) {
  if (name == "36h11") family_ = tag36h11_create();
  if (name == "25h9") family_ = tag25h9_create();
  if (name == "16h5") family_ = tag16h5_create();
}

MarkerFamily::~MarkerFamily() {
  if (!family_) return;
  if (name_ == "36h11") tag36h11_destroy(family_);
  if (name_ == "25h9") tag25h9_destroy(family_);
  if (name_ == "16h5") tag16h5_destroy(family_);
}

size_t MarkerFamily::count() const { return family_ ? family_->ncodes : 0; }

cv::Mat MarkerFamily::picture(size_t id) const {
  image_u8_t* image = apriltag_to_image(family_, static_cast<int>(id));
  const int white = (family_->total_width - family_->width_at_border) / 2, side = family_->width_at_border;
  cv::Mat cells(side, side, CV_8U);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) cells.at<uint8_t>(y, x) = image->buf[(y + white) * image->stride + x + white];
  image_u8_destroy(image);
  return cells;
}

}  // namespace odograph
