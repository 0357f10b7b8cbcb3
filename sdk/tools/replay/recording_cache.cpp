// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/recording_cache.hpp"

#include <fstream>
#include <sstream>

#include <zlib.h>

#include "sdk/tools/console/console.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

/// Increment with every change of the simulator's output, so that old recordings are not reused.
constexpr int kSimulator = 6;

}  // namespace

Result<std::string> text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    return Failure{ODO_E_NOT_FOUND, file.string() + ": no such file (run from the source folder, or give its path)"};
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string simulator_mark(const std::string& content) {
  return text("%08lx",
              crc32(kSimulator, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
}

fs::path assets_of(const fs::path& recording) { return fs::path(recording).replace_extension(".assets"); }

Result<fs::path> cached_recording(const fs::path& file, uint64_t seed, const fs::path& keep, double first_m) {
  const auto yaml = scenario_text(file.string());
  if (!yaml) return yaml.failure();
  auto scenario = read_scenario(file.string());
  if (!scenario) return scenario.failure();
  if (first_m > 0) scenario->walk_m = first_m;
  const std::string mark = text("-s%llu-%s%s.odo", static_cast<unsigned long long>(seed), simulator_mark(*yaml).c_str(),
                                first_m > 0 ? "-quick" : "");
  std::error_code error;
  fs::create_directories(keep, error);
  const fs::path kept = keep / (file.stem().string() + mark);
  const fs::path assets = assets_of(kept);
  fs::create_directories(assets, error);
  if (!scenario->objects.empty() &&
      !(fs::exists(assets / "objects.yaml", error) && fs::exists(assets / "ground.obj", error)))
    if (const auto written = write_known_objects(*scenario, seed, assets); !written) return written.failure();
  if (fs::exists(kept, error)) return kept;
  const fs::path part = kept.string() + ".part";  // an interrupted run leaves no partial recording under the final name
  Progress progress("sim " + file.stem().string() + " seed " + std::to_string(seed));
  const auto done =
      simulate(*scenario, seed, part,
               {.progress = [&](size_t i, size_t n) { progress.show(i, n); }, .city = assets / "city.json"});
  if (!done) return done.failure();
  fs::rename(part, kept, error);
  if (error) return Failure{ODO_E_IO, kept.string() + ": cannot be written"};
  return kept;
}

}  // namespace odograph
