// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// A key that vouches for plugins (plugins.signers).
struct Signer {
  std::string ids;  // an id, a beginning and '*' ("acme/*"), or "*" for all
  std::string key;  // Ed25519 public key, 32 bytes in hex

  bool vouches_for(const std::string& id) const;
};

/// Whether one of `keys` (Ed25519 public keys, 32 bytes in hex) has signed the manifest: NAME.odoplugin.sig beside
/// it holds the 64 bytes of its signature (RFC 8032, of the manifest's text as it was read: not of what the file holds
/// by now). The manifest's SHA-256 binds the library to it. Uses the machine's OpenSSL, which is loaded when it is
/// needed and is no other part of this library. ODO_E_CONFIG with what is wrong; ODO_E_UNSUPPORTED where there is no
/// OpenSSL (1.1.1 or later).
Result<bool> verify_signature(const Manifest& manifest, const std::vector<std::string>& keys);

}  // namespace odograph
