// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/validator/case_fixture.hpp"
#include "tests/support/support.hpp"

/// A plugin of the build, run manually on whole recordings.
class PluginRun {
 public:
  using Settings = std::vector<std::pair<std::string, std::string>>;

  /// `name` of its library: "attitude_vqf".
  explicit PluginRun(const std::string& name, const Settings& settings = {})
      : fixture_(plugin_folder() / (name + ".so"), settings, 0) {
    const std::string why = fixture_.load();
    REQUIRE_MESSAGE(why.empty(), why);
    try {
      driver_ = fixture_.start_instance();
    } catch (const odograph::Verdict& verdict) {
      FAIL(name, ": ", verdict.detail);
    }
  }

  /// Passes those messages that the plugin's kind receives, one by one; returns its output.
  std::vector<odograph::AnyMessage> operator()(const std::vector<odograph::AnyMessage>& messages) {
    std::vector<odograph::AnyMessage> wanted, out;
    for (const auto& message : messages)
      if (fixture_.accepts(message.header().type)) wanted.push_back(message);
    driver_->events.clear();
    driver_->process(wanted);
    CHECK(driver_->violations.empty());
    for (auto& event : driver_->events) out.push_back(std::move(event.message));
    return out;
  }
  void reset() { REQUIRE(driver_->reset() == ODO_OK); }

 private:
  odograph::CaseFixture fixture_;
  std::unique_ptr<odograph::PluginDriver> driver_;
};

/// Whether two runs gave the same events, byte by byte.
inline bool same_events(const std::vector<odograph::AnyMessage>& one, const std::vector<odograph::AnyMessage>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](const auto& a, const auto& b) {
    return std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin(), b.bytes().end());
  });
}
