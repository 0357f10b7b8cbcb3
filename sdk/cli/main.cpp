// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <unistd.h>

#include <odograph/odograph.h>

#include "sdk/base/printable.hpp"
#include "sdk/cli/city.hpp"
#include "sdk/cli/commands.hpp"

namespace odograph {

int complain(const Failure& failure) {
  std::fprintf(stderr, "%s\n", printable(failure.text).c_str());
  switch (failure.status) {
    case ODO_E_CONFIG:
    case ODO_E_ARGUMENT:
    case ODO_E_UNSUPPORTED: return kBadUsage;
    case ODO_E_DATA:
    case ODO_E_VERSION:
    case ODO_E_NOT_FOUND: return kBadData;
    default: return kPluginFailure;
  }
}

Result<Recording> open_recording(const std::string& path, const ReadOptions& options) {
  auto recording = read_recording(path, options);
  if (recording)
    for (const auto& warning : recording->warnings)
      std::fprintf(stderr, "%s\n", printable(path + ": " + warning).c_str());
  return recording;
}

int status_over(const RecordingLoss& loss, int status) {
  return loss.any() && (status == kDone || status == kLostTracking) ? kBadData : status;
}

Progress::Progress(std::string what) : what_(std::move(what)), on_(isatty(STDERR_FILENO) != 0) {}
Progress::~Progress() {
  if (on_ && percent_ >= 0) std::fprintf(stderr, "\r\033[K");
}
void Progress::show(size_t done, size_t all) {
  const int percent = all > 0 ? static_cast<int>(100 * done / all) : 100;
  if (!on_ || percent == percent_) return;
  percent_ = percent;
  std::string bar(static_cast<size_t>(percent) * 3 / 10, '#');
  std::fprintf(stderr, "\r%s [%-30s] %3d %%", what_.c_str(), bar.c_str(), percent);
  std::fflush(stderr);
}

}  // namespace odograph

int main(int argc, char** argv) {
  CLI::App app{"Odograph: a metric 6-DoF pose from a hand-held phone's sensors"};
  app.require_subcommand(1);
  app.set_version_flag("--version", odo_version());
  app.footer(
      "Exit status: 0 done, 1 ran but lost tracking, 2 bad usage or config, 3 bad data, or "
      "some of the input was lost (what could be read was used), 4 plugin failure.");
  int status = odograph::kDone;
  odograph::add_run(app, status);
  odograph::add_eval(app, status);
  odograph::add_sim(app, status);
  odograph::add_steps(app, status);
  odograph::add_compare(app, status);
  odograph::add_config(app, status);
  odograph::add_plugins(app, status);
  odograph::add_convert(app, status);
  odograph::add_calibrate(app, status);
  odograph::add_bench(app, status);
  odograph::add_city(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? odograph::kDone : odograph::kBadUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "odograph: %s\n", odograph::printable(error.what()).c_str());
    return odograph::kBadData;
  }
  return status;
}
