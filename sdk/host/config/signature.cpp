// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/signature.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <optional>

#include "sdk/host/platform/library.hpp"

namespace odograph {
namespace {

constexpr size_t kKeyBytes = 32, kSignatureBytes = 64;
constexpr int kEd25519 = 1087;  // NID_ED25519 of <openssl/obj_mac.h>, frozen

using Key = std::array<unsigned char, kKeyBytes>;

/// The functions of libcrypto that are used (man EVP_DigestVerify, EVP_PKEY_new_raw_public_key).
struct Crypto {
  void* (*new_key)(int type, void* engine, const unsigned char* key, size_t size) = nullptr;
  void (*free_key)(void* key) = nullptr;
  void* (*new_context)() = nullptr;
  void (*free_context)(void* context) = nullptr;
  int (*begin)(void* context, void** key_context, const void* digest, void* engine, void* key) = nullptr;
  int (*verify)(void* context, const unsigned char* signature, size_t signature_size, const unsigned char* data,
                size_t size) = nullptr;

  static const Crypto* get() {
    static const std::optional<Crypto> loaded = load();
    return loaded ? &*loaded : nullptr;
  }

 private:
  static std::optional<Crypto> load() {
    for (const char* name : {"libcrypto.so.4", "libcrypto.so.3", "libcrypto.so.1.1", "libcrypto.3.dylib"}) {
      std::string why;
      void* library = open_library(name, why);
      if (!library) continue;
      Crypto c;
      const auto find = [&](auto& function, const char* symbol) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(library_symbol(library, symbol));
        return function != nullptr;
      };
      if (find(c.new_key, "EVP_PKEY_new_raw_public_key") && find(c.free_key, "EVP_PKEY_free") &&
          find(c.new_context, "EVP_MD_CTX_new") && find(c.free_context, "EVP_MD_CTX_free") &&
          find(c.begin, "EVP_DigestVerifyInit") && find(c.verify, "EVP_DigestVerify"))
        return c;
    }
    return {};
  }
};

std::optional<Key> key_of(const std::string& hex) {
  Key key{};
  if (hex.size() != 2 * kKeyBytes) return {};
  for (size_t i = 0; i < kKeyBytes; ++i) {
    const char* digits = hex.data() + 2 * i;
    if (const auto [end, error] = std::from_chars(digits, digits + 2, key[i], 16);
        error != std::errc() || end != digits + 2)
      return {};
  }
  return key;
}

/// Reads the signature and at most one byte more; nothing if it is not a regular file.
std::optional<std::string> signature_of(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  std::string bytes(kSignatureBytes + 1, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(file.gcount()));
  return bytes;
}

bool is_signed(const Crypto& crypto, const Key& key, const std::string& text, const std::string& signature) {
  const auto bytes = [](const std::string& s) { return reinterpret_cast<const unsigned char*>(s.data()); };
  void* public_key = crypto.new_key(kEd25519, nullptr, key.data(), key.size());
  void* context = crypto.new_context();
  const bool good = public_key && context && crypto.begin(context, nullptr, nullptr, nullptr, public_key) == 1 &&
                    crypto.verify(context, bytes(signature), signature.size(), bytes(text), text.size()) == 1;
  crypto.free_context(context);
  crypto.free_key(public_key);
  return good;
}

}  // namespace

bool Signer::covers(const std::string& id) const {
  const bool open = !ids.empty() && ids.back() == '*';
  return open ? id.starts_with(std::string_view(ids).substr(0, ids.size() - 1)) : id == ids;
}

Result<bool> verify_signature(const Manifest& manifest, const std::vector<std::string>& texts) {
  std::vector<Key> keys;
  for (const std::string& each : texts) {
    const auto key = key_of(each);
    if (!key)
      return Failure{ODO_E_CONFIG,
                     "plugins.signers: '" + each + "'; expected a public key of 32 bytes as 64 hexadecimal digits"};
    keys.push_back(*key);
  }
  const std::string who = "plugin '" + manifest.id + "': ";
  std::filesystem::path file = manifest.path;
  file.replace_extension(".sig");
  const auto signature = signature_of(file);
  if (!signature || signature->size() != kSignatureBytes)
    return Failure{ODO_E_CONFIG, who + file.string() + (signature ? " has another size" : " is missing") +
                                     "; expected the " + std::to_string(kSignatureBytes) +
                                     " bytes of an Ed25519 signature, because plugins.signers has a key for its id"};
  const Crypto* crypto = Crypto::get();
  if (!crypto)
    return Failure{ODO_E_UNSUPPORTED, who + "plugins.signers needs OpenSSL (libcrypto 1.1.1 or 3) on this machine"};
  const auto signed_by = [&](const Key& key) { return is_signed(*crypto, key, manifest.text, *signature); };
  if (std::none_of(keys.begin(), keys.end(), signed_by))
    return Failure{ODO_E_CONFIG, who + file.string() +
                                     " is no signature of its manifest by any of plugins.signers for its id (" +
                                     std::to_string(keys.size()) + ")"};
  if (const auto hash = sha256_of(manifest.library); !hash || *hash != manifest.sha256)
    return Failure{ODO_E_CONFIG, who + manifest.library.string() + ": its hash differs from its signed manifest's"};
  return true;
}

}  // namespace odograph
