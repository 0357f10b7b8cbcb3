// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/config/registry.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("documents");

TEST_CASE("every plugin has a README that lists exactly its parameters") {
  const PluginRegistry registry({plugin_folder()});
  REQUIRE(registry.manifests().size() >= 8);
  for (const Manifest& manifest : registry.manifests()) {
    CAPTURE(manifest.id);
    const std::string text = read_text(source("plugins") / manifest.id / "README.md");
    REQUIRE_FALSE(text.empty());
    std::vector<std::string> named;
    const std::regex row("\\n\\| `([a-z_0-9]+)` \\|");
    for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) named.push_back((*it)[1]);
    std::vector<std::string> actual;
    for (const Spec& spec : manifest.parameters) actual.push_back(spec.name);
    CHECK(named == actual);
  }
}

TEST_CASE("every YAML example of the documents is a valid config or part of one") {
  int examples = 0;
  for (const auto& folder : {source("."), source("docs"), source("docs/accuracy")})
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".md") continue;
      const std::string text = read_text(entry.path());
      const std::regex block("```yaml\\n([\\s\\S]*?)```");
      for (std::sregex_iterator it(text.begin(), text.end(), block), end; it != end; ++it) {
        const std::string yaml = (*it)[1];
        if (yaml.rfind("odograph: 1", 0) != 0) continue;
        CAPTURE(entry.path().string());
        const auto config = read_pipeline_config(yaml, entry.path().filename().string(), {plugin_folder()});
        CHECK_MESSAGE(config.ok(), (config.ok() ? "" : config.failure().text));
        ++examples;
      }
    }
  CHECK(examples >= 1);
}
