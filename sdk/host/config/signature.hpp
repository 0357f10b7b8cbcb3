// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// A key that may sign plugins (plugins.signers).
struct Signer {
  std::string ids;  // an id, a prefix and '*' ("acme/*"), or "*" for all
  std::string key;  // Ed25519 public key, 32 bytes in hex

  bool covers(const std::string& id) const;
};

/// Whether one of `keys` (Ed25519 public keys, 32 bytes in hex) has signed the manifest. NAME.odoplugin.sig beside it
/// contains the 64 bytes of the signature (RFC 8032) of the manifest's text as it was read, not of the file's present
/// content. The manifest's SHA-256 binds the library to it. Loads the system's OpenSSL on demand; this library does not
/// link to it. ODO_E_CONFIG with the reason; ODO_E_UNSUPPORTED without OpenSSL (1.1.1 or later).
Result<bool> verify_signature(const Manifest& manifest, const std::vector<std::string>& keys);

}  // namespace odograph
