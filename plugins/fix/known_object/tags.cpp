// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/tags.hpp"

#include <map>
#include <stdexcept>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>

#include "plugins/fix/known_object/plane_object.hpp"

namespace odograph::known_object {
namespace {

class Family {
 public:
  explicit Family(const std::string& name) : name_(name) {
    if (name == "36h11") family_ = tag36h11_create();
    if (name == "25h9") family_ = tag25h9_create();
    if (name == "16h5") family_ = tag16h5_create();
    if (!family_) throw std::runtime_error("family '" + name + "' is unknown; expected 36h11, 25h9 or 16h5");
  }
  ~Family() {
    if (name_ == "36h11") tag36h11_destroy(family_);
    if (name_ == "25h9") tag25h9_destroy(family_);
    if (name_ == "16h5") tag16h5_destroy(family_);
  }
  Family(const Family&) = delete;
  Family& operator=(const Family&) = delete;
  apriltag_family_t* get() const { return family_; }

 private:
  std::string name_;
  apriltag_family_t* family_ = nullptr;
};

}  // namespace

cv::Mat tag_picture(const std::string& name, int tag) {
  constexpr int kCell_px = 16;
  const Family family(name);
  if (tag < 0 || tag >= static_cast<int>(family.get()->ncodes))
    throw std::runtime_error("family " + name + " has no tag " + std::to_string(tag));
  image_u8_t* image = apriltag_to_image(family.get(), tag);
  const int white = (family.get()->total_width - family.get()->width_at_border) / 2;
  const int side = family.get()->width_at_border;
  cv::Mat picture(side * kCell_px, side * kCell_px, CV_8U);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      picture.at<uint8_t>(y, x) = image->buf[(y / kCell_px + white) * image->stride + x / kCell_px + white];
  image_u8_destroy(image);
  return picture;
}

struct TagDetector::Library {
  std::map<std::string, std::unique_ptr<Family>> families;
  apriltag_detector_t* detector = apriltag_detector_create();
  ~Library() { apriltag_detector_destroy(detector); }
};

TagDetector::TagDetector(const std::vector<std::string>& families) : library_(std::make_unique<Library>()) {
  library_->detector->quad_decimate = 1;
  for (const std::string& name : families) {
    auto& family = library_->families[name];
    if (family) continue;
    family = std::make_unique<Family>(name);
    apriltag_detector_add_family_bits(library_->detector, family->get(), p_.wrong_bits);
  }
}

TagDetector::~TagDetector() = default;

std::vector<SeenTag> TagDetector::find(const cv::Mat& grey) const {
  image_u8_t image = {grey.cols, grey.rows, static_cast<int>(grey.step), grey.data};
  zarray_t* found = apriltag_detector_detect(library_->detector, &image);
  std::vector<SeenTag> seen;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* detection;
    zarray_get(found, i, &detection);
    if (detection->decision_margin < p_.min_margin) continue;
    SeenTag tag;
    for (const auto& [name, family] : library_->families)
      if (family->get() == detection->family) tag.family = name;
    tag.number = detection->id;
    for (size_t k = 0; k < 4; ++k)
      tag.corners[k] = {static_cast<float>(detection->p[k][0]), static_cast<float>(detection->p[k][1])};
    seen.push_back(tag);
  }
  apriltag_detections_destroy(found);
  return seen;
}

}  // namespace odograph::known_object
