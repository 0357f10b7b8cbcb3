// SPDX-License-Identifier: Apache-2.0
//
// Reads a recording, and tracks a walk live, in C++17.
//   walk CONFIG.yaml RECORDING.odo
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <odograph/odograph.hpp>

namespace {

const char kConfig[] = R"(odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
)";

void show(const odo::Event& event) {
  if (const auto pose = event.get<odo_pose>())
    std::printf("pose %lld %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", static_cast<long long>(pose->header.t_ns),
                pose->p_n[0], pose->p_n[1], pose->p_n[2], pose->q_n[1], pose->q_n[2], pose->q_n[3], pose->q_n[0]);
  if (const auto points = event.points(); points && points->size() > 0) {  // landmarks, the most certain first
    const odo_point& first = (*points)[0];
    std::printf("points %u first %llu %.17g\n", points->size(), static_cast<unsigned long long>(first.id),
                static_cast<double>(first.p_c[2]));
  }
}

/// Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library.
size_t decode(std::string_view picture, odo_frame& frame) {
  int begin = 0;
  if (std::sscanf(picture.data(), "P5 %u %u 255%n", &frame.width, &frame.height, &begin) != 2) return 0;
  return static_cast<size_t>(begin) + 1;
}

void grey(odo_frame& frame, const uint8_t* pixels) {
  frame.format = ODO_FORMAT_GREY8, frame.plane_count = 1;
  frame.planes[0] = {pixels, frame.width, 1, 0};
}

/// Puts an anchor on what lies ahead, 45 degrees down: usually the floor.
void place(odo::Session& session) {
  odo_ray ray{};
  ray.kind = ODO_RAY_VIEW, ray.t_ns = ODO_TIME_LATEST, ray.direction[1] = ray.direction[2] = 1;
  for (const odo_hit& hit : session.hit_test(ray, 1)) {
    const uint64_t anchor = session.create_anchor(odo::Session::place_of(hit), "on the floor");
    std::printf("hit %u %llu %.17g anchor %llu\n", hit.what, static_cast<unsigned long long>(hit.surface),
                hit.distance_m, static_cast<unsigned long long>(anchor));
  }
}

void replay(const char* config, const char* file) {
  odo::Session session(odo::Options().file(config));
  session.on_event(show, {ODO_TYPE_POSE, ODO_TYPE_POINTS});
  odo::Recording recording(file);
  for (const odo::Recorded& recorded : recording) {
    if (auto frame = recorded.message.get<odo_frame>()) {
      const size_t begin = decode(recorded.picture, *frame);
      if (begin == 0) continue;
      grey(*frame, reinterpret_cast<const uint8_t*>(recorded.picture.data()) + begin);
      session.push(*frame);  // it may become invalid after the call: the library copies what it needs
    } else if (!ODO_IS_EVENT(recorded.message.header().type)) {
      session.push(recorded.message);
    }
  }
  session.flush();
  place(session);
}

void live() {
  int steps = 0;
  odo::Session session(odo::Options().text(kConfig).live());
  session.on_event([&](const odo::Event&) { ++steps; }, {ODO_TYPE_STEP});
  const auto picture = std::make_shared<std::vector<uint8_t>>(64 * 48, uint8_t{90});  // as from a camera
  for (int i = 0; i < 1000; ++i) {
    const double t = i * 0.01;
    const int64_t t_ns = 1'000'000'000 + i * 10'000'000LL;
    session.push_imu(t_ns, {0, 0.01, 0}, {0.1, 9.81 + 2.2 * std::sin(12 * t), 0.4});
    if (i % 10 != 0) continue;
    auto frame = odo::make<odo_frame>(t_ns);
    frame.width = 64, frame.height = 48;
    grey(frame, picture->data());
    session.push(frame, picture);  // shared, not copied
    session.flush();               // needed only because the simulated time does not wait
  }
  const odo_pose pose = session.pose().value();
  auto place = odo::sized<odo_anchor_place>();
  place.kind = ODO_ANCHOR_VIEW, place.t_ns = ODO_TIME_LATEST, place.p[2] = -3;
  const odo_anchor anchor = session.anchor(session.create_anchor(place, "a label"));
  std::printf("live %d steps %.17g %.17g %.17g label %.2f %.2f %.2f borrowed %ld\n", steps, pose.p_n[0], pose.p_n[1],
              pose.p_n[2], anchor.p_n[0], anchor.p_n[1], anchor.p_n[2], picture.use_count() - 1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: %s CONFIG.yaml RECORDING.odo\n", argv[0]), 2;
  try {
    replay(argv[1], argv[2]);
    live();
  } catch (const odo::Error& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
  return 0;
}
