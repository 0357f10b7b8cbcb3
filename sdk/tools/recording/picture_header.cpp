// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/picture_header.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

namespace odograph {
namespace {

constexpr int kMaxMarkers = 1000;  // of a JPEG before its size
constexpr int kMaxBytes = 4096;    // of a PGM's comments
constexpr size_t kLongestHeader = 1 << 20;

uint32_t big_endian(const unsigned char* bytes, int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

/// ISO/IEC 10918-1, B.2: markers with lengths, up to a frame header (SOF).
std::optional<PictureSize> jpeg(std::istream& in) {
  unsigned char head[7];
  for (int i = 0; i < kMaxMarkers && in.read(reinterpret_cast<char*>(head), 4); ++i) {
    while (head[0] == 0xFF && head[1] == 0xFF) {  // fill bytes
      std::memmove(head, head + 1, 3);
      if (!in.read(reinterpret_cast<char*>(head) + 3, 1)) return std::nullopt;
    }
    if (head[0] != 0xFF) return std::nullopt;
    const uint32_t marker = head[1], length = big_endian(head + 2, 2);
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (length < 2) return std::nullopt;
    if (!frame) {
      in.seekg(length - 2, std::ios::cur);
      continue;
    }
    if (!in.read(reinterpret_cast<char*>(head), 5)) return std::nullopt;
    return PictureSize{big_endian(head + 3, 2), big_endian(head + 1, 2)};
  }
  return std::nullopt;
}

/// netpbm: numbers separated by white space and comments.
std::optional<PictureSize> netpbm(std::istream& in) {
  uint32_t numbers[2] = {};
  int count = 0, digits = 0;
  bool comment = false;
  for (int i = 0; i < kMaxBytes && count < 2; ++i) {
    const int c = in.get();
    if (c == EOF) return std::nullopt;
    if (comment || c == '#') {
      comment = c != '\n';
    } else if (std::isdigit(c) && digits < 9) {
      numbers[count] = numbers[count] * 10 + static_cast<uint32_t>(c - '0');
      ++digits;
    } else if (std::isspace(c)) {
      count += digits > 0 ? 1 : 0;
      digits = 0;
    } else {
      return std::nullopt;
    }
  }
  if (count < 2) return std::nullopt;
  return PictureSize{numbers[0], numbers[1]};
}

std::optional<PictureSize> stated_size(std::istream& in, uint64_t offset) {
  unsigned char head[26] = {};
  in.read(reinterpret_cast<char*>(head), sizeof head);
  const auto got = in.gcount();
  in.clear();
  const auto continue_at = [&](uint64_t byte) -> std::istream& {
    return in.seekg(static_cast<std::streamoff>(offset + byte));
  };
  if (got >= 24 && std::memcmp(head, "\x89PNG\r\n\x1a\n", 8) == 0 && std::memcmp(head + 12, "IHDR", 4) == 0)
    return PictureSize{big_endian(head + 16, 4), big_endian(head + 20, 4)};
  if (got >= 2 && head[0] == 0xFF && head[1] == 0xD8) return jpeg(continue_at(2));
  if (got >= 26 && head[0] == 'B' && head[1] == 'M') {
    int32_t size[2];
    std::memcpy(size, head + 18, sizeof size);
    const int64_t height = size[1];  // negative: rows from the top
    return PictureSize{static_cast<uint32_t>(size[0]), static_cast<uint32_t>(height < 0 ? -height : height)};
  }
  if (got >= 3 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6') return netpbm(continue_at(2));
  return std::nullopt;
}

/// ISO/IEC 23008-12: a file type box with a brand of still pictures.
bool is_heif(std::string_view head) {
  if (head.substr(4, 4) != "ftyp") return false;
  const std::string_view brand = head.substr(8, 4);
  return brand.starts_with("he") || brand == "mif1" || brand == "msf1" || brand.starts_with("avi");
}

Result<PictureSize> checked_size(std::istream& in, uint64_t offset, const std::string& name) {
  const auto size = stated_size(in, offset);
  if (!size || size->width == 0 || size->height == 0) {
    in.clear();
    in.seekg(static_cast<std::streamoff>(offset));
    char head[12] = {};
    if (in.read(head, sizeof head) && is_heif({head, sizeof head}))
      return Failure{ODO_E_DATA, name +
                                     ": HEIC and AVIF are not read; convert it to JPEG with its EXIF data, for "
                                     "example with heif-convert"};
    return Failure{ODO_E_DATA, name + ": no picture; expected PNG, JPEG, BMP, PGM or PPM"};
  }
  if (size->width > kMaxSide || size->height > kMaxSide || uint64_t(size->width) * size->height > kMaxPixels)
    return Failure{ODO_E_DATA, name + ": a picture of " + std::to_string(size->width) + " x " +
                                   std::to_string(size->height) + " pixels; expected at most 64 million, " +
                                   std::to_string(kMaxSide) + " a side"};
  return *size;
}

}  // namespace

Result<PictureSize> picture_size(const std::filesystem::path& file, uint64_t offset) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  if (!in) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be opened"};
  return checked_size(in, offset, file.string());
}

Result<PictureSize> picture_size(std::span<const unsigned char> bytes, const std::string& name) {
  std::istringstream in(
      std::string(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), kLongestHeader))));
  return checked_size(in, 0, name);
}

}  // namespace odograph
