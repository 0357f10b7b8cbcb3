// SPDX-License-Identifier: Apache-2.0
//
// Configs, where the plugins that they may name are there: two short manifests, which are read anew each time.
#include <cstdint>
#include <string>

#include <odograph/attitude.h>
#include <odograph/plugin.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/config/pipeline_config.hpp"
#include "tests/fuzz/scratch.hpp"

namespace {

void put_manifest(const std::string& name, const std::string& interface_id, const std::string& parameters) {
  const std::string text = "{\"odoplugin\": 1, \"id\": \"" + name + "\", \"version\": \"1.0.0\", \"summary\": \"\", " +
                           "\"interfaces\": [\"" + interface_id + "\"], \"abi\": [0, 1], \"library\": \"x.so\", " +
                           "\"sha256\": \"\", \"parameters\": [" + parameters + "]}";
  fuzz::put(name.substr(name.find('/') + 1) + ".odoplugin.json",
            {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto folder = [] {
    put_manifest(
        "attitude/vqf", ODO_INTERFACE_ATTITUDE,
        "{\"name\": \"tau\", \"type\": \"real\", \"unit\": \"s\", \"min\": 1, \"max\": 9, \"default\": \"3\"}, "
        "{\"name\": \"axis\", \"type\": \"reals\", \"default\": \"[0, 1, -1]\", \"count\": 3}");
    put_manifest("vo/odograph", ODO_INTERFACE_VO_FRONTEND,
                 "{\"name\": \"kind\", \"type\": \"choice\", \"default\": \"a\", \"choices\": \"a|b\"}");
    return fuzz::folder();
  }();
  (void)odograph::read_pipeline_config(std::string(reinterpret_cast<const char*>(data), size), "fuzz.yaml", {folder});
  return 0;
}
