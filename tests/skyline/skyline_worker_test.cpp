// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <stdexcept>

#include "plugins/fix/skyline/sliced_worker.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "tests/skyline/rendered_street.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline_worker");

namespace {

int advances_until_done(SlicedWorker& worker, uint64_t slice) {
  int n = 1;
  while (!worker.advance(slice)) ++n;
  return n;
}

double milliseconds_of(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void sleep_ms(int n) { std::this_thread::sleep_for(std::chrono::milliseconds(n)); }

}  // namespace

TEST_CASE("after how many frames a job is done is told by its work, not by how long it took") {
  SlicedWorker worker;
  for (const int slow_ms : {0, 3}) {
    for (const int pause_ms : {0, 5}) {
      worker.start(
          [&](const Spend& spend) {
            for (int k = 0; k < 10; ++k) spend(60), sleep_ms(slow_ms);
          },
          100);
      CHECK(worker.busy());
      sleep_ms(pause_ms);
      CHECK(advances_until_done(worker, 100) == 6);  // 600 of work, the first 100 with the start
      CHECK_FALSE(worker.busy());
    }
  }
}

TEST_CASE("a frame waits for one slice at most") {
  SlicedWorker worker;
  worker.start(
      [](const Spend& spend) {
        for (int k = 0; k < 40; ++k) spend(50), sleep_ms(5);  // two of them per slice, 200 ms in all
      },
      100);
  double longest_ms = 0;
  for (bool done = false; !done;)
    longest_ms = std::max(longest_ms, milliseconds_of([&] { done = worker.advance(100); }));
  CHECK(longest_ms == Between{5, 100});  // 10 on an idle machine
}

TEST_CASE("a job that throws tells so where it is asked for, and the next one runs") {
  SlicedWorker worker;
  worker.start([](const Spend&) { throw std::runtime_error("no sky"); }, 10);
  CHECK_THROWS_WITH(advances_until_done(worker, 10), "no sky");
  CHECK_FALSE(worker.busy());
  bool ran = false;
  worker.start([&](const Spend&) { ran = true; }, 10);
  CHECK(advances_until_done(worker, 10) == 1);
  CHECK(ran);
}

TEST_CASE("a worker that goes while its job waits or works ends the job") {
  std::atomic<bool> went_on = false;
  CHECK(milliseconds_of([&] {
          SlicedWorker worker;
          worker.start(
              [&](const Spend& spend) {
                spend(1000);
                went_on = true;
              },
              10);
        }) < 1000);
  CHECK_FALSE(went_on);
  SlicedWorker never_started;
}

namespace {

constexpr int64_t kFrame_ns = 33'333'333;

struct LateFix {
  int64_t t_ns, told_ns;
  double north, east;
  bool operator==(const LateFix&) const = default;
};

/// Runs the plugin on frames of a camera at rest, each with its pose; `slow_ms` of wall-clock time passes between two
/// frames.
std::vector<LateFix> fixes_of(const std::filesystem::path& folder, const Vector3d& place, const Vector3d& prior,
                              double sigma_m, int frames, int slow_ms, double* longest_ms = nullptr,
                              const char* parameters = "min_agreement: 0.6") {
  std::string said;
  HostServices host(0, {folder}, [&](const Report& report) { said += report.text + '\n'; });
  const auto config = required(read_pipeline_config(
      std::string("odograph: 1\nabsolute_fixers:\n  - plugin: fix/skyline\n    parameters: {model: city.json, ") +
          parameters + "}\n",
      "<text>", {plugin_folder()}));
  auto made = required(PluginInstance::make(config->fixers.front(), LibraryCheck::hash, 1, host));
  PluginInstance& plugin = **made;
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.source = 1, c.model = ODO_CAMERA_KANNALA_BRANDT, c.width = 640, c.height = 480, c.distortion_count = 4;
  c.fx = c.fy = 200, c.cx = 319.5, c.cy = 239.5;
  plugin.process(c.header);
  const cv::Mat picture = view_upwards(place);
  std::vector<LateFix> fixes;
  for (int k = 1; k <= frames; ++k) {
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, k * kFrame_ns);
    pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_CAMERA | ODO_POSE_METRIC;
    Vector3d::Map(pose.p_n) = prior;
    pose.q_n[1] = 1;  // half a revolution about x
    pose.covariance[0] = pose.covariance[7] = 1e-4, pose.covariance[14] = 4e-4;
    pose.covariance[21] = pose.covariance[28] = sigma_m * sigma_m;
    plugin.process(pose.header);
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, k * kFrame_ns);
    frame.format = ODO_FORMAT_GREY8, frame.header.source = 1, frame.width = 640, frame.height = 480;
    frame.planes[0].data = picture.data, frame.planes[0].row_stride = 640, frame.planes[0].pixel_stride = 1;
    double took_ms = 0;
    std::span<AnyMessage> events;
    took_ms = milliseconds_of([&] { events = plugin.process(frame.header); });
    if (longest_ms) *longest_ms = std::max(*longest_ms, took_ms);
    for (AnyMessage& event : events)
      if (event.header().type == ODO_TYPE_FIX) {
        const auto& fix = reinterpret_cast<const odo_fix&>(event.header());
        fixes.push_back({fix.header.t_ns, frame.header.t_ns, fix.p_n[0], fix.p_n[1]});
      }
    if (slow_ms) sleep_ms(slow_ms);
  }
  CHECK(plugin.faults() == 0);
  CHECK_MESSAGE(!fixes.empty(), said);
  return fixes;
}

}  // namespace

TEST_CASE("fixes come some frames after the picture that they speak of, and the same ones at any speed") {
  const TemporaryFolder folder;
  write_street(folder / "city.json");
  const Vector3d place(3.2, -1.7, -1.5);
  const auto at_once = fixes_of(folder.path(), place, place + Vector3d(-1, 0.8, 0), 1.0, 60, 0);
  REQUIRE(at_once.size() >= 2);
  for (const LateFix& fix : at_once) {
    CHECK(std::hypot(fix.north - place.x(), fix.east - place.y()) < 0.6);
    CHECK(fix.told_ns > fix.t_ns);
    CHECK(fix.told_ns - fix.t_ns < 10 * kFrame_ns);
  }
  CHECK(at_once == fixes_of(folder.path(), place, place + Vector3d(-1, 0.8, 0), 1.0, 60, 20));
}

TEST_CASE("with a survey of the roofs too fixes are the same ones at any speed, and no frame waits for much of it") {
  const TemporaryFolder folder;
  write_street(folder / "city.json", {3.5, -4, 3, -4, 3.5, -3});
  const Vector3d place(3.2, -1.7, -1.5), prior = place + Vector3d(-0.8, 0.5, 0);
  double longest_ms = 0;
  const auto at_once = fixes_of(folder.path(), place, prior, 1.0, 300, 0, &longest_ms, "min_agreement: 0.75");
  REQUIRE(at_once.size() >= 2);
  for (const LateFix& fix : at_once) CHECK(std::hypot(fix.north - place.x(), fix.east - place.y()) < 0.6);
  CHECK(at_once == fixes_of(folder.path(), place, prior, 1.0, 300, 5, nullptr, "min_agreement: 0.75"));
  MESSAGE("longest frame: " << longest_ms << " ms");
}

TEST_CASE("a wide search is spread over many frames") {
  const TemporaryFolder folder;
  write_street(folder / "city.json");
  const Vector3d place(3.2, -1.7, -1.5);
  double longest_ms = 0;
  const auto fixes = fixes_of(folder.path(), place, place + Vector3d(-9, 8, 0), 12.0, 120, 0, &longest_ms);
  REQUIRE(fixes.size() >= 1);
  CHECK(std::hypot(fixes[0].north - place.x(), fixes[0].east - place.y()) < 0.6);
  CHECK(fixes[0].told_ns - fixes[0].t_ns >= 4 * kFrame_ns);
  MESSAGE("longest frame: " << longest_ms << " ms; the fix came " << (fixes[0].told_ns - fixes[0].t_ns) / kFrame_ns
                            << " frames late");
}
