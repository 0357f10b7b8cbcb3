// SPDX-License-Identifier: Apache-2.0
#include "options.hpp"

#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace {

constexpr const char* kUsage =
    "usage: ar_overlay CONFIG.yaml (RECORDING.odo | --camera N) [options]\n"
    "  -o FILE.mp4                     write a video\n"
    "  --picture SECONDS:FILE.png      write one picture; may be repeated\n"
    "  --drop SECONDS:NAME:X,Y,Z       place an object right, down and ahead of the camera, m\n"
    "  --tap SECONDS:NAME:COLUMN,ROW   place an object where this pixel's ray meets a surface or a landmark\n"
    "  --place NAME:LAT,LON,HEIGHT     a geodetic position: degrees, metres above the ellipsoid\n"
    "  --map FILE                      map of the place (fix/map): read if it exists, written at the end, with what\n"
    "                                  was dropped and tapped\n"
    "  --for SECONDS                   stop after this time\n"
    "  --height METRES                 height of the phone above the ground (1.45)\n"
    "  --factor N                      enlargement of the picture (2)\n";

std::vector<std::string> split(const std::string& text, char by, size_t most) {
  std::vector<std::string> parts;
  size_t begin = 0;
  while (parts.size() + 1 < most) {
    const size_t end = text.find(by, begin);
    if (end == std::string::npos) break;
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

bool three(const std::string& text, double* out) {
  return std::sscanf(text.c_str(), "%lf,%lf,%lf", out, out + 1, out + 2) == 3;
}

bool take(const std::string& key, const std::string& value, Options& options) {
  if (key == "-o") return options.video = value, true;
  if (key == "--map") return options.map = value, true;
  if (key == "--camera") return options.camera = std::atoi(value.c_str()), true;
  if (key == "--for") return options.for_s = std::atof(value.c_str()), options.for_s > 0;
  if (key == "--height") return options.height_m = std::atof(value.c_str()), options.height_m > 0;
  if (key == "--factor") return options.factor = std::atoi(value.c_str()), options.factor >= 1 && options.factor <= 8;
  if (key == "--picture") {
    const auto parts = split(value, ':', 2);
    if (parts.size() != 2) return false;
    options.pictures.push_back({std::atof(parts[0].c_str()), parts[1]});
    return true;
  }
  if (key == "--drop") {
    const auto parts = split(value, ':', 3);
    Options::Drop drop{};
    if (parts.size() != 3 || !three(parts[2], drop.p)) return false;
    drop.at_s = std::atof(parts[0].c_str()), drop.name = parts[1];
    options.drops.push_back(drop);
    return true;
  }
  if (key == "--tap") {
    const auto parts = split(value, ':', 3);
    Options::Drop drop{};
    if (parts.size() != 3 || std::sscanf(parts[2].c_str(), "%lf,%lf", drop.p, drop.p + 1) != 2) return false;
    drop.at_s = std::atof(parts[0].c_str()), drop.name = parts[1], drop.touched = true;
    options.drops.push_back(drop);
    return true;
  }
  if (key == "--place") {
    const auto parts = split(value, ':', 2);
    double at[3];
    if (parts.size() != 2 || !three(parts[1], at)) return false;
    options.places.push_back({parts[0], at[0], at[1], at[2]});
    return true;
  }
  return false;
}

}  // namespace

bool read_options(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word[0] != '-') {
      (options.config.empty() ? options.config : options.recording) = word;
    } else if (i + 1 >= argc || !take(word, argv[i + 1], options)) {
      return std::fprintf(stderr, "ar_overlay: %s: invalid value\n%s", word.c_str(), kUsage), false;
    } else {
      ++i;
    }
  }
  if (!options.config.empty() && options.recording.empty() != (options.camera < 0)) return true;
  return std::fprintf(stderr, "%s", kUsage), false;
}
