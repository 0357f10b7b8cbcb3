// SPDX-License-Identifier: Apache-2.0
#include "sdk/cli/replayed.hpp"

#include "sdk/cli/kept_recordings.hpp"

namespace odograph {

void RecordingChoice::add_options(CLI::App& command, const std::string& what) {
  command.add_option("recordings", recordings, what + "; none: simulated ones");
  command.add_option("--scenario", scenario, "what is simulated")->capture_default_str();
  command.add_option("--seeds", seeds, "how many of it")->capture_default_str()->check(CLI::Range(1, 1000));
  command.add_option("--first-seed", first_seed, "the first of them")->capture_default_str();
  command.add_option("--keep", keep, "recordings are kept here and rendered once")->capture_default_str();
}

Result<std::vector<std::filesystem::path>> RecordingChoice::files() const {
  std::vector<std::filesystem::path> files(recordings.begin(), recordings.end());
  for (uint64_t seed = first_seed; recordings.empty() && seed < first_seed + seeds; ++seed) {
    const auto file = kept_recording(scenario, seed, keep, 0);
    if (!file) return file.failure();
    files.push_back(*file);
  }
  return files;
}

Result<SessionHandle> replay_session(const std::string& config) {
  odo_session_options o{};
  o.struct_size = sizeof o;
  o.run = ODO_RUN_REPLAY;
  o.config_path = {config.data(), config.size()};
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session* session = nullptr;
  if (const int32_t status = odo_session_create(&o, &session, &error); status != ODO_OK)
    return Failure{status, error.message};
  return SessionHandle(session, odo_session_destroy);
}

std::optional<Failure> push(odo_session* session, const RecordedMessage& message) {
  const odo_header& header = message.message.header();
  if (header.type != ODO_TYPE_FRAME) {
    odo_session_push(session, &header);
    return std::nullopt;
  }
  const auto picture = load_frame(message);
  if (!picture) return picture.failure();
  odo_session_push(session, &picture->header);
  picture->release(&*picture);
  return std::nullopt;
}

}  // namespace odograph
