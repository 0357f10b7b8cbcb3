// SPDX-License-Identifier: Apache-2.0
//
// Maps of fix/map with a corrected checksum; a picture is looked up in those that are accepted.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <opencv2/imgproc.hpp>
#include <zlib.h>

#include "plugins/fix/map/map_section.hpp"
#include "sdk/tools/simulation/random.hpp"

using namespace odograph::place_map;

namespace {

/// The one from which the seed was made: what the fuzzer changes is recognised in part.
Picture painted() {
  odograph::Random random(1, 1);
  Picture picture;
  picture.grey = cv::Mat(120, 160, CV_8U, cv::Scalar(128));
  const auto below = [&](uint64_t n) { return static_cast<int>(random.next() % n); };
  for (int i = 0; i < 80; ++i) {
    const int x = below(160), y = below(120), wide = 4 + below(30), high = 4 + below(30);
    cv::rectangle(picture.grey, cv::Rect(x, y, wide, high), below(256), cv::FILLED);
  }
  cv::GaussianBlur(picture.grey, picture.grey, {0, 0}, 0.8);
  picture.lens.fx = picture.lens.fy = 400, picture.lens.cx = 79.5, picture.lens.cy = 59.5;
  return picture;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Picture picture = painted();
  std::vector<uint8_t> bytes(data, data + size);
  if (size > 4) {
    const auto checksum = static_cast<uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(size - 4)));
    std::memcpy(bytes.data() + size - 4, &checksum, sizeof checksum);
  }
  auto read = key_frames_of(bytes);
  if (std::holds_alternative<std::string>(read)) return 0;
  PlaceMap map;
  map.restore(std::get<std::vector<KeyFrame>>(std::move(read)));
  if (std::holds_alternative<std::string>(key_frames_of(bytes_of(map)))) std::abort();  // a saved map must be accepted
  const QueryView view = view_of(picture, map.parameters().features);
  const auto found = map.best_of(view, map.candidates(view));
  if (found && !(found->T_k_c.p.allFinite() && found->covariance.allFinite())) std::abort();
  map.thin(map.bytes() / 2);
  return 0;
}
