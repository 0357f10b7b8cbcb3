// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Whether a folder contains the files of a supported app (docs/phone_recordings.md).
bool looks_like_phone_recording(const std::filesystem::path& folder);

/// Recognises GnssLogger's text by its first lines.
bool looks_like_gnss_log(const std::filesystem::path& file);
Result<Recording> read_gnss_log(const std::filesystem::path& file);

/// Reads a phone's recording; `keep` is the folder that it was unpacked into. Assumptions, and sensors that the app did
/// not record, are warnings. ODO_E_DATA, with file, column and the app's option to enable.
Result<Recording> read_phone(const std::filesystem::path& path, std::shared_ptr<const void> keep = {});

}  // namespace odograph
