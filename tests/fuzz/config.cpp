// SPDX-License-Identifier: Apache-2.0
//
// Configs that name linked plugins: two short manifests.
#include <cstdint>
#include <cstdlib>
#include <string>

#include <odograph/attitude.h>
#include <odograph/plugin.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/config/linked_plugins.hpp"
#include "sdk/host/config/pipeline_config.hpp"

namespace {

/// No session is created with it.
template <int Number>
int32_t ODO_CALL entry(const odo_host*, odo_plugin*) {
  return ODO_E_UNSUPPORTED - Number;
}

void link(const std::string& name, const std::string& interface_id, const std::string& parameters,
          odo_plugin_entry entry) {
  auto manifest = odograph::parse_manifest("{\"odoplugin\": 1, \"id\": \"" + name +
                                               "\", \"version\": \"1.0.0\", \"summary\": \"\", \"interfaces\": [\"" +
                                               interface_id + "\"], \"abi\": [0, 1], \"library\": \"x.so\", " +
                                               "\"sha256\": \"\", \"parameters\": [" + parameters + "]}",
                                           "x.odoplugin.json");
  if (!manifest) std::abort();
  manifest->entry = entry;
  if (!odograph::add_linked_plugin(*manifest)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool linked = [] {
    link("attitude/vqf", ODO_INTERFACE_ATTITUDE,
         "{\"name\": \"tau\", \"type\": \"real\", \"unit\": \"s\", \"min\": 1, \"max\": 9, \"default\": \"3\"}, "
         "{\"name\": \"axis\", \"type\": \"reals\", \"default\": \"[0, 1, -1]\", \"count\": 3}",
         entry<1>);
    link("vo/odograph", ODO_INTERFACE_VO_FRONTEND,
         "{\"name\": \"kind\", \"type\": \"choice\", \"default\": \"a\", \"choices\": \"a|b\"}", entry<2>);
    return true;
  }();
  (void)linked;
  (void)odograph::read_pipeline_config(std::string(reinterpret_cast<const char*>(data), size), "fuzz.yaml", {});
  return 0;
}
