// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {

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
