// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <stdexcept>

#include <png.h>

#include "plugins/fix/known_object/read_objects.hpp"

namespace odograph::known_object {

cv::Mat read_png(const std::filesystem::path& file) {
  constexpr uint64_t kMaxPixels = 16'000'000;
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  const auto fail = [&](const std::string& why) -> std::runtime_error {
    png_image_free(&image);
    return std::runtime_error(file.string() + ": " + why);
  };
  if (!png_image_begin_read_from_file(&image, file.c_str())) throw fail(image.message);
  if (uint64_t{image.width} * image.height > kMaxPixels) throw fail("more than 16 million pixels");
  if (image.width < 16 || image.height < 16) throw fail("fewer than 16 pixels on a side");
  image.format = PNG_FORMAT_GRAY;
  cv::Mat grey(static_cast<int>(image.height), static_cast<int>(image.width), CV_8U);
  const png_color white = {255, 255, 255};  // background of transparent pixels
  if (!png_image_finish_read(&image, &white, grey.data, static_cast<png_int_32>(grey.step), nullptr))
    throw fail(image.message);
  return grey;
}

}  // namespace odograph::known_object
