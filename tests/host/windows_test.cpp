// SPDX-License-Identifier: Apache-2.0
//
// Differences on Windows: lists of folders at ';', names beyond ASCII, its loader's messages, access lists, locks.
#include <windows.h>

#include <aclapi.h>

#include <odograph/recording.h>
#include <odograph/scale_source.h>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/config/registry.hpp"
#include "sdk/host/platform/file_access.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("windows");

namespace {

const std::u8string kName = u8"Größe und 測位";  // beyond ASCII and beyond any one code page

/// Result of a session with plugins from these folders only.
std::string refusal(const std::string& folders, const std::string& config) {
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.config_text = {config.data(), config.size()};
  options.plugin_path = {folders.data(), folders.size()};
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) != ODO_OK) return error.message;
  odo_session_destroy(session);
  return "";
}

/// Grants everybody these rights, in addition to others' rights.
void grant_everybody(const fs::path& path, DWORD rights) {
  wchar_t everyone[] = L"Everyone";
  EXPLICIT_ACCESS_W entry{};
  BuildExplicitAccessWithNameW(&entry, everyone, rights, GRANT_ACCESS, NO_INHERITANCE);
  unsigned char sid[SECURITY_MAX_SID_SIZE];
  DWORD size = sizeof sid;
  REQUIRE(CreateWellKnownSid(WinWorldSid, nullptr, sid, &size));
  entry.Trustee.TrusteeForm = TRUSTEE_IS_SID;
  entry.Trustee.ptstrName = reinterpret_cast<LPWSTR>(sid);
  ACL *before = nullptr, *after = nullptr;
  std::wstring name = path.wstring();
  REQUIRE(GetNamedSecurityInfoW(name.data(), SE_FILE_OBJECT, DACL_SECURITY_INFORMATION, nullptr, nullptr, &before,
                                nullptr, nullptr) == ERROR_SUCCESS);
  REQUIRE(SetEntriesInAclW(1, &entry, before, &after) == ERROR_SUCCESS);
  REQUIRE(SetNamedSecurityInfoW(name.data(), SE_FILE_OBJECT, DACL_SECURITY_INFORMATION, nullptr, nullptr, after,
                                nullptr) == ERROR_SUCCESS);
}

}  // namespace

TEST_CASE("plugins come from a list of folders at ';', with drives and names beyond ASCII") {
  const TemporaryFolder folder;
  const fs::path mine = folder.path() / kName;
  fs::create_directory(mine);
  const fs::path library = mine / "listens.dll";
  fs::copy_file(built("tests/hostile/listens.dll"), library);
  REQUIRE(write_manifest_beside(library).ok());
  CHECK(path_list("C:\\a;D:\\b;;") == std::vector<fs::path>{"C:\\a", "D:\\b"});
  const std::string config = "odograph: 1\nvo_frontend: {plugin: test/listens}\n";
  const std::string list = mine.string() + ";" + plugin_folder().string();
  CHECK(refusal(list, config) == "");
  CHECK(refusal(list, config + "plugins: {verify_hash: true}\n") == "");
  CHECK(refusal(list, config + "plugins: {allow: [" + *sha256_of(library) + "]}\n") == "");
  CHECK(contains(refusal(plugin_folder().string(), config), "no plugin 'test/listens'"));
}

TEST_CASE("the environment's folders are read as Unicode") {
  const std::wstring list = L"C:\\eins;C:\\" + fs::path(kName).wstring();
  SetEnvironmentVariableW(L"ODOGRAPH_PLUGIN_PATH", list.c_str());
  REQUIRE(_wputenv_s(L"ODOGRAPH_PLUGIN_PATH", list.c_str()) == 0);
  const auto folders = plugin_directories({"first"});
  REQUIRE(folders.size() >= 3);
  CHECK(folders[0] == "first");
  CHECK(folders[1] == "C:\\eins");
  CHECK(folders[2] == fs::path("C:\\") / kName);
  _wputenv_s(L"ODOGRAPH_PLUGIN_PATH", L"");
}

TEST_CASE("a recording's name is UTF-8") {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / (kName + u8".odo");
  const std::string name = path.string();
  const odo_string text{name.data(), name.size()};
  odo_recorder* out = nullptr;
  REQUIRE(odo_recorder_create(&text, &out, nullptr) == ODO_OK);
  const auto sample = make_message<odo_barometer>(ODO_TYPE_BAROMETER, 10);
  CHECK(odo_recorder_write(out, &sample.header, nullptr, 0) == ODO_OK);
  CHECK(odo_recorder_close(out) == ODO_OK);
  CHECK(GetFileAttributesW(path.c_str()) != INVALID_FILE_ATTRIBUTES);
  odo_recording* in = nullptr;
  REQUIRE(odo_recording_open(&text, &in, nullptr) == ODO_OK);
  const odo_header* message = nullptr;
  REQUIRE(odo_recording_next(in, &message, nullptr, nullptr) == ODO_OK);
  CHECK(message->t_ns == 10);
  odo_recording_close(in);
}

TEST_CASE("isolation is rejected with its location in the config") {
  const std::string text = refusal(plugin_folder().string(),
                                   "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  isolation: process\n"
                                   "step_estimator: {plugin: step/renaudin2012}\n");
  CHECK(contains(text, ":3:"));
  CHECK(contains(text, "cannot run in a process of its own"));
  CHECK(contains(text, "platform (windows)"));
  CHECK(contains(text, "expected 'isolation: none'"));
}

TEST_CASE("a file that is not a library is rejected with the loader's reason") {
  const TemporaryFolder folder;
  const HostServices host(0, {"."}, nullptr);
  const auto why = [&](const fs::path& path) { return PluginLibrary::load(path, &host).failure().text; };
  const fs::path good = built("tests/hostile/good.dll");
  const std::string bytes = read_text(good);
  CHECK(contains(why(folder / "missing.dll"), "cannot be opened"));
  for (const std::string& content : {std::string("this is no library"), std::string(), bytes.substr(0, 70)}) {
    const fs::path file = write_text(folder / "bad.dll", content);
    CHECK(contains(why(file), "the loader refused it: "));
    CHECK(contains(why(file), "(error "));
  }
  CHECK(PluginLibrary::load(good, &host).ok());
}

TEST_CASE("a plugin that everybody may change, or a folder that everybody may write to, is rejected") {
  for (const bool of_folder : {true, false}) {
    const TemporaryFolder folder;
    fs::copy_file(built("tests/hostile/good.dll"), folder / "one.dll");
    REQUIRE(write_manifest_beside(folder / "one.dll").ok());
    const auto found = [&] {
      PluginRegistry registry({folder.path()});
      const auto manifest = registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {});
      return manifest ? std::string() : manifest.failure().text;
    };
    CHECK(found() == "");
    const fs::path open = of_folder ? folder.path() : folder / "one.dll";
    CHECK_FALSE(is_world_writable(open, false));
    grant_everybody(open, FILE_GENERIC_READ | FILE_GENERIC_WRITE);
    CHECK(is_world_writable(open, false));
    CHECK(contains(found(), "may be written to by every user"));
  }
}

TEST_CASE("two writers of one file exclude each other, and the complete file replaces the existing one") {
  const TemporaryFolder folder;
  const fs::path file = write_text(folder / "out.txt", "old");
  write_text(folder / "out.txt.part", "left by a crash");
  {
    auto out = required(OutputFile::create(file));
    CHECK(FileLock::is_held(folder / "out.txt.part"));
    out->stream() << "new\n";
    const auto other = OutputFile::create(file);
    REQUIRE_FALSE(other.ok());
    CHECK(other.failure().status == ODO_E_STATE);
    CHECK(read_text(file) == "old");
    REQUIRE(out->commit().ok());
  }
  CHECK(read_text(file) == "new\n");  // and no carriage return
  CHECK_FALSE(fs::exists(folder / "out.txt.part"));
  CHECK(write_whole_file(file, "newer").ok());
  { OutputFile::create(file)->stream() << "dropped"; }
  CHECK(read_text(file) == "newer");
  CHECK_FALSE(fs::exists(folder / "out.txt.part"));
}
