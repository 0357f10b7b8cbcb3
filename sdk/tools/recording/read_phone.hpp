// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Whether a folder holds what one of the apps writes (docs/phone_recordings.md).
bool looks_like_phone_recording(const std::filesystem::path& folder);

/// GnssLogger's text, by its first lines.
bool looks_like_gnss_log(const std::filesystem::path& file);
Result<Recording> read_gnss_log(const std::filesystem::path& file);

/// A phone's recording; `keep` is what it was unpacked into. What had to be guessed, and what the app did not record,
/// are warnings. ODO_E_DATA in words: which file, which column, what to switch on in the app.
Result<Recording> read_phone(const std::filesystem::path& path, std::shared_ptr<const void> keep = {});

}  // namespace odograph
