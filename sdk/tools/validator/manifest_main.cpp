// SPDX-License-Identifier: Apache-2.0
//
// odograph-manifest FILE.so ...: writes NAME.odoplugin.json beside each plugin library. Only this program loads a
// plugin without a manifest; the build and vendors run it once, users never do.
#include <cstdio>
#include <fstream>

#include "sdk/host/plugin_host/library.hpp"
#include "sdk/tools/validator/write_manifest.hpp"

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const auto written = odograph::write_manifest_beside(argv[i]);
    if (!written) {
      std::fprintf(stderr, "%s\n", written.failure().text.c_str());
      return 4;
    }
  }
  return 0;
}
