// SPDX-License-Identifier: Apache-2.0
//
// Which plugins are accepted: allowed ones, signed ones, ones that nobody else may replace; and limits of their
// reports.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <odograph/scale_source.h>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/config/registry.hpp"
#include "sdk/host/config/signature.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "sdk/tools/validator/write_manifest.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("plugin_trust");

namespace {

// Made with OpenSSL, `openssl pkeyutl -sign -rawin`, over the manifest of a library with the content "not a library".
const char* const kSigner = "86ee01c8e079893e5ea4b692c1ed183f8963b8bbaf497479be97e0d55ae0478f";
const char* const kSignature =
    "ccee588eede5ca73677331bbd54101a77dbca94edbd9bb171f55ff115fe7acafcd63799469e07be31cc859e0a97b5de89011a2df37f3d15293"
    "7a26446f8d1d01";
const char* const kSignedKind = "odo.attitude/1";
const char* const kSigned =
    R"({"odoplugin": 1, "id": "test/signed", "version": "1.0.0", "summary": "Signed.", )"
    R"("interfaces": ["odo.attitude/1"], "abi": [1, 0], "library": "one.so", )"
    R"("sha256": "f6bb034ecdd65239971cf2fbc49cb6ecef0dc0a192e40c2884e68e3346503e69", "parameters": []})";

std::string bytes_of_hex(const std::string& hex) {
  std::string bytes;
  for (size_t i = 0; i + 1 < hex.size(); i += 2) bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

/// A library with a manifest, alone in its folder, with unique bytes: `mark` is appended.
Manifest put_library(const TemporaryFolder& folder, const std::string& name, const std::string& mark) {
  write_text(folder / "one.so", read_text(hostile(name)) + mark);
  REQUIRE(write_manifest_beside(folder / "one.so").ok());
  auto manifest = required(read_manifest(folder / "one.odoplugin.json"));
  return *manifest;
}

void put_signed(const TemporaryFolder& folder) {
  write_text(folder / "one.so", "not a library");
  write_text(folder / "one.odoplugin.json", kSigned);
  write_text(folder / "one.odoplugin.sig", bytes_of_hex(kSignature));
}

}  // namespace

TEST_CASE("plugins are allowed by id, by path and by the hash of their library") {
  const TemporaryFolder folder;
  copy_plugin(hostile("good"), folder / "one.so");
  const auto find = [&](const std::string& item) {
    PluginRegistry registry({folder.path()});
    return registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {folder.path()}, {"some/other", item}).ok();
  };
  const std::string hash = *sha256_of(folder / "one.so");
  CHECK(find("test/hostile"));
  CHECK(find("one.so"));
  CHECK(find((folder / "one.odoplugin.json").string()));
  CHECK(find(hash));
  CHECK_FALSE(find("two.so"));
  CHECK_FALSE(find("/tmp"));
  CHECK_FALSE(find(std::string(64, '0')));
  CHECK_FALSE(find(hash.substr(1)));
}

TEST_CASE("a world-writable plugin is rejected unless allowed") {
  for (const char* part : {"", "one.so", "one.odoplugin.json"}) {
    const TemporaryFolder folder;
    copy_plugin(hostile("good"), folder / "one.so");
    const auto open = *part ? folder / part : folder.path();
    fs::permissions(open, fs::perms::others_write, fs::perm_options::add);
    CAPTURE(open.string());
    PluginRegistry registry({folder.path()});
    const auto found = registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {});
    REQUIRE_FALSE(found.ok());
    CHECK(contains(found.failure().text, "may be written to by every user"));
    registry.allow_writable(true);
    CHECK(registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {}).ok());
  }
}

TEST_CASE("a plugin behind a link or below a world-writable folder is rejected as well") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "mine");
  fs::create_directories(folder / "open/deep");
  copy_plugin(hostile("good"), folder / "open/deep/one.so");
  const auto find = [&](const fs::path& where) {
    PluginRegistry registry({where});
    const auto found = registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {});
    return found ? std::string() : found.failure().text;
  };
  CHECK(find(folder / "open/deep") == "");
  fs::permissions(folder / "open", fs::perms::others_write, fs::perm_options::add);
  CHECK(contains(find(folder / "open/deep"), "may be written to by every user"));
  fs::permissions(folder / "open", fs::perms::sticky_bit, fs::perm_options::add);  // as /tmp: nobody else may rename
  CHECK(find(folder / "open/deep") == "");
  fs::permissions(folder / "open", fs::perms::sticky_bit, fs::perm_options::remove);
  for (const char* file : {"one.so", "one.odoplugin.json"})
    fs::create_symlink(folder / "open/deep" / file, folder / "mine" / file);
  CHECK(contains(find(folder / "mine"), "may be written to by every user"));
}

TEST_CASE("a signature applies to the manifest as read, whatever its file contains later") {
  const TemporaryFolder folder;
  put_signed(folder);
  auto manifest = required(read_manifest(folder / "one.odoplugin.json"));
  const auto verified = verify_signature(*manifest, {kSigner});
  if (!verified && verified.failure().status == ODO_E_UNSUPPORTED) {
    return skip("no OpenSSL");
  }
  CHECK(verified.ok());
  write_text(folder / "one.odoplugin.json", "{}");
  CHECK(verify_signature(*manifest, {kSigner}).ok());
  // The converse: the read manifest is not the later, correctly signed one.
  put_signed(folder);
  std::string swapped = kSigned;
  swapped.replace(swapped.find("Signed."), 7, "Swapped");
  manifest = parse_manifest(swapped, folder / "one.odoplugin.json");
  REQUIRE(manifest.ok());
  CHECK(contains(verify_signature(*manifest, {kSigner}).failure().text, "is no signature of its manifest"));
  CHECK(contains(verify_signature(*manifest, {kSigner, "abc"}).failure().text, "expected a public key of 32 bytes"));
  CHECK(contains(verify_signature(*manifest, {std::string(64, 'g')}).failure().text, "expected a public key"));
}

TEST_CASE("a signer vouches for its given ids, which need its signature, and all others need none") {
  const TemporaryFolder folder;
  put_signed(folder);
  const auto found = [&](const std::string& id, const std::vector<Signer>& signers) {
    PluginRegistry registry({folder.path()});
    registry.require_signature(signers);
    const auto manifest = registry.find(id, kSignedKind, {folder.path()}, {});
    return manifest ? std::string() : manifest.failure().text;
  };
  const std::string stranger(64, '1');
  if (contains(found("test/signed", {{"*", kSigner}}), "needs OpenSSL")) return skip("no OpenSSL");
  for (const char* ids : {"*", "test/*", "test/signed", "test/sign*"}) {
    CAPTURE(ids);
    CHECK(found("test/signed", {{ids, kSigner}}) == "");
    CHECK(contains(found("test/signed", {{ids, stranger}}), "is no signature of its manifest"));
    CHECK(found("test/signed", {{ids, stranger}, {"test/*", kSigner}}) == "");
  }
  fs::remove(folder / "one.odoplugin.sig");
  CHECK(contains(found("test/signed", {{"test/*", kSigner}}), "one.odoplugin.sig is missing"));
  for (const char* ids : {"acme/*", "test", "test/signed2", "test/s"})
    CHECK(found("test/signed", {{ids, kSigner}}) == "");
  // Loaded by path, a manifest may state any id; that does not bypass the signers.
  CHECK(found("one.odoplugin.json", {}) == "");
  CHECK(contains(found("one.odoplugin.json", {{"acme/*", kSigner}}), "is chosen by its path"));
}

TEST_CASE("a key that vouches for nothing is an error in the config") {
  const auto refusal = [](const std::string& signer) {
    const auto config =
        read_pipeline_config("odograph: 1\nplugins: {signers: [" + signer + "]}\nattitude: {plugin: attitude/vqf}\n",
                             "test", {plugin_folder()});
    return config ? std::string() : config.failure().text;
  };
  const std::string key = std::string(", key: ") + kSigner + "}";
  CHECK(refusal("{ids: acme/*" + key) == "");  // ours are not signed
  for (const char* ids : {"'*/vo'", "'acme*/vo'", "'**'", "''"})
    CHECK(contains(refusal(std::string("{ids: ") + ids + key), "expected an id, with '*' only at its end"));
  CHECK(contains(refusal("{ids: acme/*}"), "the key 'key' is missing"));
  CHECK(contains(refusal("{ids: '*'" + key), "attitude_vqf.odoplugin.sig is missing"));
  CHECK(contains(refusal(std::string("{key: ") + kSigner + "}"), "attitude_vqf.odoplugin.sig is missing"));
}

TEST_CASE("lists of folders are split at ';' on Windows, whose drives have ':'") {
  CHECK(path_list("a:b::/c", ':') == std::vector<fs::path>{"a", "b", "/c"});
  CHECK(path_list("C:\\a;D:\\b", ';') == std::vector<fs::path>{"C:\\a", "D:\\b"});
  CHECK(path_list("").empty());
}

#if defined(__linux__)
TEST_CASE("a library allowed by its hash is opened as hashed, whatever its file contains later") {
  const TemporaryFolder folder, other;
  const HostServices host(0, {"."}, nullptr);
  const Manifest manifest = put_library(folder, "good", "sealed 1"), second = put_library(other, "good", "sealed 2");
  const auto copy = required(sealed_copy(manifest));
  write_text(folder / "one.so", read_text(hostile("refuses")));  // the same file, other bytes
  CHECK(PluginLibrary::load(manifest, LibraryCheck::sealed, &host).ok());
  CHECK(contains(PluginLibrary::load(manifest, LibraryCheck::hash, &host).failure().text, "hash differs"));
  CHECK(contains(PluginLibrary::load(manifest, LibraryCheck::none, &host).failure().text, "refused to start"));
  CHECK(read_text(*copy) == read_text(hostile("good")) + "sealed 1");
  const int fd = open(copy->c_str(), O_RDWR);
  CHECK((fd < 0 || write(fd, "x", 1) < 0));
  CHECK((fd < 0 || ftruncate(fd, 0) < 0));
  if (fd >= 0) close(fd);
  // One library per hash.
  const auto first = PluginLibrary::load(manifest, LibraryCheck::sealed, &host);
  const auto again = PluginLibrary::load(manifest, LibraryCheck::sealed, &host);
  const auto apart = PluginLibrary::load(second, LibraryCheck::sealed, &host);
  REQUIRE((first.ok() && again.ok() && apart.ok()));
  CHECK((*first)->path() == manifest.library);
  CHECK(((*first)->table().process == (*again)->table().process));
  CHECK(((*first)->table().process != (*apart)->table().process));
}

TEST_CASE(
    "a sealed copy whose descriptor the app has closed and used for another file is made again, under another number") {
  const TemporaryFolder folder;
  const HostServices host(0, {"."}, nullptr);
  const Manifest manifest = put_library(folder, "good", "closed");
  const auto before = required(sealed_copy(manifest));
  const int number = std::stoi(before->filename().string());
  CHECK(close(number) == 0);
  const int other = open("/dev/null", O_RDONLY);
  const auto after = required(sealed_copy(manifest));
  CHECK(*after != *before);
  CHECK(read_text(*after) == read_text(hostile("good")) + "closed");
  CHECK(PluginLibrary::load(manifest, LibraryCheck::sealed, &host).ok());
  close(other);
  CHECK(*required(sealed_copy(manifest)) == *after);
}

TEST_CASE("a sealed copy has all bytes of a library whose last read gives a single one") {
  const TemporaryFolder folder;
  const size_t padding = (1 << 20) + 1 - read_text(hostile("good")).size() % (1 << 20);  // it is read by MiB
  const auto copy = required(sealed_copy(put_library(folder, "good", std::string(padding, 'x'))));
  CHECK(read_text(*copy) == read_text(folder / "one.so"));
}

TEST_CASE("a session runs a plugin allowed by its hash from memory, in process and isolated, with identical results") {
  const std::string hash = *sha256_of(plugin_folder() / "attitude_vqf.so");
  const auto events = [](const std::string& plugins) {
    RunningApp app(kWalk + plugins);
    app.run(0, 500);
    return app.events;
  };
  const std::string allow = "plugins:\n  allow: [step/renaudin2012, " + hash + "]\n";
  const auto plain = events("");
  REQUIRE(plain.size() > 500);
  CHECK(plain == events(allow + "  isolation: process\n"));
  CHECK_FALSE(contains(read_text("/proc/self/maps"), "/memfd:attitude_vqf.so"));
  CHECK(plain == events(allow));
  CHECK(contains(read_text("/proc/self/maps"), "/memfd:attitude_vqf.so"));
}

TEST_CASE("a library that differs from its manifest is not sealed, and is reported with its own path") {
  const TemporaryFolder folder;
  const Manifest manifest = put_library(folder, "good", "unsealed");
  const auto refusal = [&] { return sealed_copy(manifest).failure().text; };
  write_text(folder / "one.so", read_text(hostile("refuses")));
  CHECK(contains(refusal(), "one.so: its hash differs from the manifest's"));
  write_text(folder / "one.so", read_text(hostile("good")).substr(0, 5000));
  CHECK(contains(refusal(), "one.so: truncated"));
  write_text(folder / "one.so", "");
  CHECK(contains(refusal(), "one.so: not an ELF file"));
  fs::remove(folder / "one.so");
  CHECK(contains(refusal(), "one.so: cannot be opened"));
}

TEST_CASE("a library that needs another one beside it has no sealed copy, which is reported") {
  const TemporaryFolder folder;
  fs::copy_file(hostile("neighbour"), folder / "neighbour.so");
  const Manifest manifest = put_library(folder, "needs_neighbour", "");
  const HostServices host(0, {"."}, nullptr);
  CHECK(contains(PluginLibrary::load(manifest, LibraryCheck::sealed, &host).failure().text,
                 "loaded from a sealed copy, for which $ORIGIN is not its folder"));
  CHECK(PluginLibrary::load(manifest, LibraryCheck::hash, &host).ok());
}
#endif

TEST_CASE("a config with hashes or signers requires sealed copies, others the hash or nothing") {
  const auto check = [](const std::string& plugins) {
    const auto config = required(
        read_pipeline_config("odograph: 1\nattitude: {plugin: attitude/vqf}\n" + plugins, "test", {plugin_folder()}));
    return config->library_check;
  };
  const std::string hash = *sha256_of(plugin_folder() / "attitude_vqf.so");
  CHECK(check("") == LibraryCheck::hash);
  CHECK(check("plugins: {verify_hash: false}\n") == LibraryCheck::none);
  CHECK(check("plugins: {allow: [attitude/vqf]}\n") == LibraryCheck::hash);
  CHECK(check("plugins: {allow: [" + hash + "]}\n") == LibraryCheck::sealed);
  CHECK(check("plugins: {verify_hash: false, allow: [" + hash + "]}\n") == LibraryCheck::sealed);
}

TEST_CASE("pipes and folders in place of library and signature are rejected at once") {
  const TemporaryFolder folder;
  put_signed(folder);
  const auto manifest = required(read_manifest(folder / "one.odoplugin.json"));
  const HostServices host(0, {"."}, nullptr);
  for (const char* name : {"one.so", "one.odoplugin.sig"})
    for (const bool pipe : {true, false}) {
      put_signed(folder);
      const fs::path path = folder / name;
      fs::remove(path);
      if (pipe)
        REQUIRE(mkfifo(path.c_str(), 0600) == 0);
      else
        fs::create_directory(path);
      CAPTURE(path.string());
      CAPTURE(pipe);
      CHECK_FALSE(verify_signature(*manifest, {kSigner}).ok());
      CHECK_FALSE(PluginLibrary::load(*manifest, LibraryCheck::hash, &host).ok());
      CHECK_FALSE(PluginLibrary::load(*manifest, LibraryCheck::sealed, &host).ok());
      CHECK_FALSE(PluginLibrary::load(path, &host).ok());
      fs::remove(path);
    }
}

TEST_CASE("a plugin that reports under new keys without end uses bounded memory and is reported under one key") {
  size_t told = 0, longest = 0;
  HostServices host(0, {}, [&](const Report& report) {
    ++told;
    longest = std::max(longest, report.key.size() + report.text.size());
  });
  for (int i = 0; i < 100'000; ++i)
    host.report(1, ODO_SEVERITY_WARNING, std::string(i < 300 ? 10'000 : 10, 'x') + std::to_string(i),
                std::string(10'000, 'y'));
  CHECK(told < 300);
  CHECK(longest < 5'000);
}
