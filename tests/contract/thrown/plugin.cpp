// SPDX-License-Identifier: Apache-2.0
//
// An attitude that throws exceptions without the wrapper's guard: yaml-cpp's, one of the standard library, and a
// number. Built with the system's C++ runtime and with its own; THROWN_ID distinguishes them.
#define HOSTILE_ID THROWN_ID
#include <stdexcept>
#include <string>

#include <odograph/attitude.h>
#include <yaml-cpp/yaml.h>

#include "tests/hostile/table.hpp"

namespace {

std::string where = "nowhere", what = "yaml";

void throws(const char* call) {
  if (where != call) return;
  if (what == "yaml") YAML::Load("[a, b");
  if (what == "standard") throw std::out_of_range("the shelf is empty");
  throw 42;
}

odo_parameter row(const char* name, const char* help, const char* standard, const char* choices) {
  const auto text = [](const char* t) { return odo_string{t, std::strlen(t)}; };
  return {sizeof(odo_parameter),
          ODO_PARAMETER_CHOICE,
          text(name),
          {},
          text(help),
          text(standard),
          text(choices),
          0,
          0,
          1,
          0};
}

}  // namespace

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_parameter rows[] = {
      row("where", "The call that it comes out of.", "nowhere", "nowhere|configure|activate|process|save|destroy"),
      row("what", "What is thrown.", "yaml", "yaml|standard|number")};
  static const odo_string kind = {ODO_INTERFACE_ATTITUDE, sizeof ODO_INTERFACE_ATTITUDE - 1};
  odo_plugin t = hostile::table();
  t.interfaces = &kind;
  t.parameters = rows, t.parameter_count = 2, t.parameter_stride = sizeof rows[0];
  t.configure = [](odo_instance*, const odo_value* values, uint32_t count, uint32_t) -> int32_t {
    for (uint32_t i = 0; i < count; ++i) {
      const std::string name(values[i].name.data, values[i].name.size);
      (name == "where" ? where : what) = std::string(values[i].text.data, values[i].text.size);
    }
    return throws("configure"), ODO_OK;
  };
  t.activate = [](odo_instance*, const odo_sink*) -> int32_t { return throws("activate"), ODO_OK; };
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return throws("process"), ODO_OK; };
  t.save = [](odo_instance*, void*, uint64_t) -> int64_t { return throws("save"), 0; };
  t.destroy = [](odo_instance*) { throws("destroy"); };
  return hostile::fill(out, t);
}
