// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/photograph.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>

#include <libexif/exif-data.h>
#include <opencv2/imgcodecs.hpp>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/tools/recording/picture_header.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kDiagonal35_mm = 43.2666;  // of a picture of 36 by 24 mm

struct Release {
  void operator()(ExifData* data) const { exif_data_unref(data); }
};

/// The entries of a file by tag; numbers are rationals or integers of any width.
class Exif {
 public:
  explicit Exif(const fs::path& file) : data_(exif_data_new_from_file(file.c_str())) {}

  std::optional<double> number(ExifIfd ifd, int tag, unsigned long index = 0) const {
    const ExifEntry* entry = find(ifd, tag);
    if (!entry || index >= entry->components) return std::nullopt;
    const size_t width = exif_format_get_size(entry->format);
    if (width == 0 || (index + 1) * width > entry->size) return std::nullopt;
    const unsigned char* at = entry->data + index * width;
    const ExifByteOrder order = exif_data_get_byte_order(data_.get());
    double value = 0;
    switch (entry->format) {
      case EXIF_FORMAT_RATIONAL: {
        const ExifRational r = exif_get_rational(at, order);
        value = r.denominator ? static_cast<double>(r.numerator) / r.denominator : NAN;
        break;
      }
      case EXIF_FORMAT_SRATIONAL: {
        const ExifSRational r = exif_get_srational(at, order);
        value = r.denominator ? static_cast<double>(r.numerator) / r.denominator : NAN;
        break;
      }
      case EXIF_FORMAT_SHORT: value = exif_get_short(at, order); break;
      case EXIF_FORMAT_LONG: value = exif_get_long(at, order); break;
      default: return std::nullopt;
    }
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }
  char letter(ExifIfd ifd, int tag) const {
    const ExifEntry* entry = find(ifd, tag);
    return entry && entry->format == EXIF_FORMAT_ASCII && entry->size > 0 ? static_cast<char>(entry->data[0]) : '\0';
  }

 private:
  const ExifEntry* find(ExifIfd ifd, int tag) const {
    return data_ ? exif_content_get_entry(data_->ifd[ifd], static_cast<ExifTag>(tag)) : nullptr;
  }
  std::unique_ptr<ExifData, Release> data_;
};

/// Degrees, minutes, seconds.
std::optional<double> angle_of(const Exif& exif, int tag, int reference, char negative) {
  const auto degrees = exif.number(EXIF_IFD_GPS, tag, 0);
  if (!degrees) return std::nullopt;
  const double value = *degrees + exif.number(EXIF_IFD_GPS, tag, 1).value_or(0) / 60 +
                       exif.number(EXIF_IFD_GPS, tag, 2).value_or(0) / 3600;
  return exif.letter(EXIF_IFD_GPS, reference) == negative ? -value : value;
}

void read_exif(const PictureSize& size, Photograph& to) {
  constexpr int kHPositioningError = 0x1f;  // missing in libexif's list
  const Exif exif(to.file);
  const double diagonal_px = std::hypot(size.width, size.height);
  if (const auto mm = exif.number(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM); mm && *mm > 0)
    to.focal_px = *mm * diagonal_px / kDiagonal35_mm;
  const auto latitude = angle_of(exif, EXIF_TAG_GPS_LATITUDE, EXIF_TAG_GPS_LATITUDE_REF, 'S');
  const auto longitude = angle_of(exif, EXIF_TAG_GPS_LONGITUDE, EXIF_TAG_GPS_LONGITUDE_REF, 'W');
  const bool known = latitude && longitude && (*latitude != 0 || *longitude != 0);
  if (known && std::abs(*latitude) <= 90 && std::abs(*longitude) <= 180) to.place_deg = {*latitude, *longitude};
  if (const auto sigma = exif.number(EXIF_IFD_GPS, kHPositioningError); sigma && *sigma > 0) to.place_sigma_m = *sigma;
  if (const auto heading = exif.number(EXIF_IFD_GPS, EXIF_TAG_GPS_IMG_DIRECTION))
    to.heading_deg = std::fmod(*heading, 360.0);
  to.heading_is_magnetic = exif.letter(EXIF_IFD_GPS, EXIF_TAG_GPS_IMG_DIRECTION_REF) == 'M';
}

/// Whether a JPEG or PNG lacks its end, which decoders only warn about. Trailing data of other programs may follow it.
bool is_truncated(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG")) return bytes.rfind("IEND") == std::string::npos;
  if (!bytes.starts_with("\xFF\xD8")) return false;
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(bytes[i]); };
  size_t at = 2;  // segments up to the first scan, one of which may hold a preview with an end of its own
  while (at + 4 <= bytes.size() && byte(at) == 0xFF && byte(at + 1) != 0xDA)
    at += byte(at + 1) == 0xFF ? 1 : 2u + (256u * byte(at + 2) + byte(at + 3));
  return bytes.find("\xFF\xD9", at) == std::string::npos;
}

}  // namespace

Result<Photograph> read_photograph(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return Failure{ODO_E_NOT_FOUND, file.string() + ": no such file"};
  if (!fs::is_regular_file(file, error))
    return Failure{ODO_E_DATA, file.string() + ": a folder or a device, not a file"};
  const auto size = picture_size(file, 0);
  if (!size) return size.failure();
  Photograph photograph{.file = file};
  read_exif(*size, photograph);
  return photograph;
}

Result<cv::Mat> read_pixels(const Photograph& photograph) {
  const std::string name = photograph.file.string();
  std::ifstream in(photograph.file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (is_truncated(bytes)) return Failure{ODO_E_DATA, name + ": the picture is truncated"};
  cv::Mat bgr;
  try {
    bgr = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()), cv::IMREAD_COLOR);
  } catch (const std::exception& thrown) {
    return Failure{ODO_E_DATA, name + ": " + thrown.what()};
  }
  if (bgr.empty()) return Failure{ODO_E_DATA, name + ": the picture cannot be read"};
  return bgr;
}

Result<double> focal_of_lens(const std::string& lens, const cv::Size& size) {
  char* end = nullptr;
  const double value = std::strtod(lens.c_str(), &end);
  const std::string unit = end;
  const double longest = std::max(size.width, size.height), diagonal = std::hypot(size.width, size.height);
  double focal = 0;
  if (unit == "mm") focal = value * diagonal / kDiagonal35_mm;
  if (unit == "px") focal = value;
  if (unit == "deg" && value > 0 && value < 170) focal = 0.5 * longest / std::tan(0.5 * value * std::numbers::pi / 180);
  if (focal > 0) return focal;
  const bool is_file = lens.ends_with(".yaml") || lens.ends_with(".yml") || fs::is_regular_file(lens);
  if (!is_file)
    return Failure{ODO_E_ARGUMENT, "--lens " + lens +
                                       ": expected 26mm (35 mm equivalent), 70deg (angle of the long side), "
                                       "1500px, or a camera.yaml"};
  if (!fs::exists(lens)) return Failure{ODO_E_NOT_FOUND, "--lens " + lens + ": no such file"};
  const auto camera = read_camera_yaml(lens, nullptr);
  if (!camera) return camera.failure();
  const double own = std::max(camera->width, camera->height);
  return 0.5 * (camera->fx + camera->fy) * longest / own;
}

}  // namespace odograph
