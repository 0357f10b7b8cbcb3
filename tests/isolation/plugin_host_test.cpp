// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/registry.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/tools/validator/write_manifest.hpp"
#include "tests/support/test_plugins.hpp"

#include <odograph/scale_source.h>

TEST_SUITE_BEGIN("plugin_host");

namespace {

std::string refusal(const fs::path& library) {
  const HostServices host(0, {"."}, nullptr);
  const auto loaded = PluginLibrary::load(library, &host);
  REQUIRE_FALSE(loaded.ok());
  CHECK(contains(loaded.failure().text, library.string()));
  return loaded.failure().text;
}

PluginChoice choice_of(const std::string& name) {
  PluginChoice choice;
  choice.manifest.id = "test/" + (name == "create_throws" ? name : std::string("hostile"));
  choice.manifest.library = hostile(name);
  choice.manifest.abi_major = ODO_ABI_MAJOR;
  choice.manifest.abi_minor = ODO_ABI_MINOR;
  choice.interface_id = ODO_INTERFACE_SCALE_SOURCE;
  return choice;
}

odo_vo_motion motion(int64_t t_ns) {
  auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
  m.t_from_ns = t_ns - 1;
  return m;
}

}  // namespace

#if defined(__ELF__)
namespace {

/// A copy of a library in a separate folder, with changed bytes.
fs::path altered(const TemporaryFolder& folder, const std::string& name,
                 const std::function<void(std::string&)>& change) {
  std::string bytes = read_text(hostile("good"));
  change(bytes);
  return write_text(folder / name, bytes);
}

}  // namespace

TEST_CASE("files that are not plugins are rejected with their path and the reason") {
  const TemporaryFolder folder;
  CHECK(contains(refusal(write_text(folder / "text.so", "this is not a library")), "not an ELF file"));
  CHECK(contains(refusal(write_text(folder / "empty.so", "")), "not an ELF file"));
  CHECK(contains(refusal(folder / "missing.so"), "cannot be opened"));
  CHECK(contains(refusal(altered(folder, "half.so", [](std::string& b) { b.resize(b.size() / 2); })), "truncated"));
  CHECK(contains(refusal(altered(folder, "head.so", [](std::string& b) { b.resize(70); })), "truncated"));
  CHECK(contains(refusal(altered(folder, "arm.so",
                                 [](std::string& b) { b[18] = static_cast<char>(b[18] == 40 ? 62 : 40), b[19] = 0; })),
                 "another machine"));
  CHECK(contains(refusal(altered(folder, "bits.so", [](std::string& b) { b[4] = b[4] == 1 ? 2 : 1; })), "word size"));
}
#endif

TEST_CASE("plugins without an entry or with an unusable table are rejected with the reason") {
  CHECK(contains(refusal(hostile("abi_too_new")),
                 "it is for ABI 3." + std::to_string(ODO_ABI_MINOR) + ", this host has major 1"));
  CHECK(contains(refusal(hostile("no_symbol")), "symbol missing"));
  CHECK(contains(refusal(hostile("refuses")), "the licence has expired"));
  CHECK(contains(refusal(hostile("table_too_small")), "its table has"));
  CHECK(contains(refusal(hostile("no_functions")), "its table lacks process"));
}

TEST_CASE("an event that is not accepted has its status and key; only one of an unknown type is no fault") {
  TypeSet outputs;
  outputs.add(ODO_TYPE_SCALE);
  const auto judged = [&](const odo_header& event) {
    AnyMessage copy;
    EventFault fault;
    const int32_t status = validate_event(event, outputs, copy, fault);
    return std::pair(status, std::string(fault.key));
  };
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 1);
  scale.scale = 1, scale.sigma = 0.1;
  CHECK(judged(scale.header) == std::pair<int32_t, std::string>(ODO_OK, ""));
  const auto refused = [&](uint32_t type, uint32_t size) {
    auto event = scale;
    event.header.type = type, event.header.struct_size = size;
    return judged(event.header);
  };
  const auto size = static_cast<uint32_t>(sizeof scale);
  CHECK(refused(ODO_TYPE_FRAME, size) == std::pair<int32_t, std::string>(ODO_E_UNSUPPORTED, "wrong_event"));
  CHECK(refused(ODO_TYPE_FIX, size) == std::pair<int32_t, std::string>(ODO_E_ARGUMENT, "wrong_event"));
  CHECK(refused(ODO_TYPE_POSE, size) == std::pair<int32_t, std::string>(ODO_E_ARGUMENT, "wrong_event"));
  CHECK(refused(0x17F0, size) == std::pair<int32_t, std::string>(ODO_E_UNSUPPORTED, ""));
  CHECK(refused(ODO_TYPE_SCALE, size - 8) == std::pair<int32_t, std::string>(ODO_E_STRUCT_SIZE, "event_size"));
  scale.scale = -1;
  CHECK(judged(scale.header) == std::pair<int32_t, std::string>(ODO_E_ARGUMENT, "bad_event"));
}

TEST_CASE("tables of newer plugins work") {
  HostServices host(0, {"."}, nullptr);
  for (const char* name : {"good", "table_larger"}) {
    CAPTURE(name);
    auto made = required(PluginInstance::make(choice_of(name), LibraryCheck::none, 1, host));
    CHECK((*made)->process(motion(5).header).empty());
    (*made)->reset();  // without a reset function the instance is created again
    CHECK((*made)->alive());
  }
}

TEST_CASE("a failed creation of an instance is reported, also if its constructor throws") {
  std::string reported;
  HostServices host(0, {"."}, [&](const Report& report) { reported += report.origin + ": " + report.text; });
  for (const char* name : {"create_throws", "create_fails", "create_null"}) {
    CAPTURE(name);
    const auto made = PluginInstance::make(choice_of(name), LibraryCheck::none, 1, host);
    REQUIRE_FALSE(made.ok());
    CHECK(contains(made.failure().text, std::string(name) + ODOGRAPH_LIBRARY));
    CHECK(contains(made.failure().text, "could not be created"));
  }
  CHECK(contains(reported, "test/create_throws: the constructor has a bad day"));
}

TEST_CASE("manifests with a duplicate id, a changed library, a false statement or a missing file are rejected") {
  const TemporaryFolder folder;
  const HostServices host(0, {"."}, nullptr);
  const auto install = [&](const std::string& name) {
    return copy_plugin(hostile("good"), folder / (name + ODOGRAPH_LIBRARY));
  };
  const auto manifest = install("one");
  {
    PluginRegistry registry({folder.path()});
    const auto found = required(registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {}));
    CHECK(PluginLibrary::load(**found, LibraryCheck::hash, &host).ok());
    CHECK_FALSE(registry.find("test/hostile", "odo.attitude/1", {}, {}).ok());
    CHECK(contains(registry.find("test/hostil", ODO_INTERFACE_SCALE_SOURCE, {}, {}).failure().text,
                   "nearest: 'test/hostile'"));
    CHECK(
        contains(registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {"a/b"}).failure().text, "allow list"));
  }
  install("two");
  {
    PluginRegistry registry({folder.path()});
    const auto found = registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {}, {});
    REQUIRE_FALSE(found.ok());
    CHECK(contains(found.failure().text, "two plugins have the id 'test/hostile'"));
    CHECK(contains(found.failure().text, "one.odoplugin.json"));
    CHECK(contains(found.failure().text, "two.odoplugin.json"));
  }
  auto read = required(read_manifest(manifest));
  read->id = "test/other";
  CHECK(
      contains(PluginLibrary::load(*read, LibraryCheck::hash, &host).failure().text, "the manifest says 'test/other'"));
  read->abi_major = 3;
  CHECK(contains(PluginLibrary::load(*read, LibraryCheck::hash, &host).failure().text,
                 "it is for ABI 3." + std::to_string(ODO_ABI_MINOR) + ", this host has major 1"));
  read->abi_major = ODO_ABI_MAJOR;
  read->sha256[0] = read->sha256[0] == '0' ? '1' : '0';
  CHECK(contains(PluginLibrary::load(*read, LibraryCheck::hash, &host).failure().text, "hash differs"));
  fs::rename(folder / (std::string("one") + ODOGRAPH_LIBRARY), folder / "gone");  // Windows cannot remove a loaded one
  CHECK(contains(PluginLibrary::load(*read, LibraryCheck::hash, &host).failure().text, "cannot be opened"));
  write_text(folder / "broken.odoplugin.json", "{\"odoplugin\": 1, \"id\": 7");
  const PluginRegistry registry({folder.path()});
  REQUIRE(registry.problems().size() == 1);
  CHECK(contains(registry.problems()[0], "broken.odoplugin.json:1:"));
}

TEST_CASE("of equal ids the first folder wins, and manifests of another major version are skipped") {
  const TemporaryFolder first, second, later;
  for (const TemporaryFolder* folder : {&first, &second, &later}) {
    copy_plugin(hostile("good"), *folder / (std::string("one") + ODOGRAPH_LIBRARY));
  }
  std::string text = read_text(later / "one.odoplugin.json");
  const auto at = text.find('[', text.find("\"abi\"")) + 1;
  text.replace(at, text.find(',', at) - at, "2");
  write_text(later / "one.odoplugin.json", text);
  PluginRegistry registry({later.path(), second.path(), first.path()});
  const auto found = required(registry.find("test/hostile", ODO_INTERFACE_SCALE_SOURCE, {"."}, {}));
  CHECK(fs::equivalent((*found)->path, second / "one.odoplugin.json"));
  REQUIRE(registry.problems().size() == 1);
  CHECK(contains(registry.problems()[0], "it is for ABI 2, this host is 1"));
}

TEST_CASE("a library may have several plugins, each with its entry and manifest, and a manifest no hash") {
  const TemporaryFolder folder;
  const HostServices host(0, {"."}, nullptr);
  copy_plugin(hostile("good"), folder / (std::string("one") + ODOGRAPH_LIBRARY));
  std::string text = read_text(folder / "one.odoplugin.json");
  const auto replace = [&](const std::string& before, const std::string& after) {
    REQUIRE(contains(text, before));
    text.replace(text.find(before), before.size(), after);
  };
  replace("\"test/hostile\"", "\"test/second\", \"entry\": \"odo_plugin_entry_v1_second\"");
  replace("\"sha256\"", "\"not_sha256\"");
  write_text(folder / "second.odoplugin.json", text);
  PluginRegistry registry({folder.path()});
  for (const char* id : {"test/hostile", "test/second"}) {
    const auto found = required(registry.find(id, ODO_INTERFACE_SCALE_SOURCE, {"."}, {}));
    CHECK(PluginLibrary::load(**found, LibraryCheck::hash, &host).ok());
    const bool bound = PluginLibrary::load(**found, LibraryCheck::sealed, &host).ok();
    CHECK(bound == ((*found)->id == "test/hostile"));  // a seal needs a hash
  }
}

TEST_CASE("a file whose whole name is the ending of manifests is no manifest") {
  const TemporaryFolder folder;
  write_text(folder / ".odoplugin.json", "{");
  CHECK(PluginRegistry({folder.path()}).problems().empty());
}

TEST_CASE("a manifest states what the library states") {
  for (const auto& entry : fs::directory_iterator(plugin_folder())) {
    if (entry.path().extension() != ODOGRAPH_LIBRARY) continue;
    CAPTURE(entry.path().string());
    const HostServices host(0, {"."}, nullptr);
    auto path = entry.path();
    path.replace_extension();
    const auto manifest = required(read_manifest(path.string() + ".odoplugin.json"));
    const auto library = required(PluginLibrary::load(*manifest, LibraryCheck::hash, &host));
    const auto specs = required(parameter_specs((*library)->table()));
    REQUIRE(specs->size() == manifest->parameters.size());
    for (size_t i = 0; i < specs->size(); ++i) {
      CHECK((*specs)[i].name == manifest->parameters[i].name);
      CHECK((*specs)[i].fallback == manifest->parameters[i].fallback);
      CHECK_FALSE((*specs)[i].help.empty());
    }
  }
}
