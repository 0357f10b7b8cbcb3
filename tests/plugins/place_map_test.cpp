// SPDX-License-Identifier: Apache-2.0
//
// fix/map's recognition on pictures of painted walls, whose geometry is exact.
#include "plugins/fix/map/place_map.hpp"

#include <Eigen/Cholesky>

#include "plugins/fix/map/agreement.hpp"
#include "plugins/fix/map/key_frame_chooser.hpp"
#include "plugins/fix/map/map_section.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/plugins/painted_wall.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace odograph::place_map;

TEST_SUITE_BEGIN("place_map");

namespace {

class Draws {
 public:
  explicit Draws(unsigned seed) : generator_(seed) {}
  Vector3d vector() {
    Vector3d v;
    for (double& x : v) x = normal_(generator_);
    return v;
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

double squared_error(const Recognition& seen, const Rigid& T_k_c) {
  Eigen::Matrix<double, 6, 1> error;
  error << odograph::log_rotation(seen.T_k_c.q * T_k_c.q.conjugate()), seen.T_k_c.p - T_k_c.p;
  return error.dot(seen.covariance.ldlt().solve(error));
}

}  // namespace

TEST_CASE("two rays with gravity give the pose from which the landmarks were projected") {
  Draws draws(3);
  for (int i = 0; i < 200; ++i) {
    const Vector3d yaw = draws.vector(), p = draws.vector();
    const Rigid T{Quaterniond(Eigen::AngleAxisd(yaw.x(), Vector3d::UnitZ())), p};
    const Vector3d X0 = Vector3d(4, 0, 0) + draws.vector(), X1 = Vector3d(4, 0, 0) + draws.vector();
    const auto poses = two_point_poses(X0, X1, (T * X0).normalized(), (T * X1).normalized());
    double best = 1e9;
    for (const Rigid& pose : poses) best = std::min(best, (pose.p - T.p).norm() + pose.q.angularDistance(T.q));
    CHECK(best < 1e-6);
  }
}

TEST_CASE("two points at the horizon leave the distance open, and give no pose") {
  CHECK(
      two_point_poses({4, 1, 0}, {4, -1, 0}, Vector3d(4, 1, 0).normalized(), Vector3d(4, -1, 0).normalized()).empty());
}

TEST_CASE("the covariance of a refined pose is that of its scatter") {
  // 2 mrad of noise on 40 rays: the mean of 6 squared normalised errors has the expectation 6.
  Draws draws(5);
  const Rigid T{odograph::exp_rotation({0.1, 0.3, -0.2}), Vector3d(0.3, -0.1, 0.4)};
  PoseParameters parameters;
  parameters.lens_rad = 0;
  double sum = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Correspondence> matches;
    for (int i = 0; i < 40; ++i) {
      Correspondence& match = matches.emplace_back();
      match.p_k = Vector3d(0, 0, 5) + draws.vector();
      match.sigma_rad = 0.002;
      const Vector3d noise = draws.vector();
      match.ray_c = ((T * match.p_k).normalized() + match.sigma_rad * noise).normalized();
    }
    const Vector3d tilt = 0.01 * draws.vector();
    const Gravity gravity{Vector3d::UnitY(), odograph::exp_rotation(tilt) * (T.q * Vector3d::UnitY()), 0.01};
    const auto refined = refine_pose(matches, gravity, {T.q, T.p + Vector3d(0.1, 0, 0)}, parameters);
    REQUIRE(refined);
    Eigen::Matrix<double, 6, 1> error;
    error << odograph::log_rotation(refined->T_c_k.q * T.q.conjugate()), refined->T_c_k.p - T.p;
    sum += error.dot(refined->information * error);
  }
  CHECK(sum / kTrials > 5);    // sigma of the mean: 0.25
  CHECK(sum / kTrials < 7.5);  // Huber's weights cost some
}

TEST_CASE("a descriptor does not depend on the phone's rotation about its axis") {
  const Wall wall(1);
  const Picture upright = wall.picture(at({0, 0, 0}));
  Picture turned = upright;  // by exactly a quarter
  cv::rotate(upright.grey, turned.grey, cv::ROTATE_90_CLOCKWISE);
  std::swap(turned.lens.cx, turned.lens.cy);
  turned.down_c = -Vector3d::UnitX();
  const PictureLevels a(upright, {}), b(turned, {});
  for (const auto& [x, y] : {std::pair(300.0, 200.0), std::pair(250.0, 260.0), std::pair(400.0, 220.0)}) {
    const auto first = a.describe({x, y}, 1), second = b.describe({479 - y, x}, 1);
    REQUIRE(first);
    REQUIRE(second);
    CHECK(hamming(*first, *second) < 20);  // places are rounded to pixels; others differ by some 60
  }
}

TEST_CASE("the distance of two descriptors is the number of different bits, up to all of them") {
  const Descriptor zeros{}, ones{~0ull, ~0ull, ~0ull, ~0ull}, some{1, 3, 7, 1ull << 63};
  CHECK(hamming(zeros, ones) == 256);
  CHECK(hamming(zeros, some) == 7);
  CHECK(hamming(some, some) == 0);
}

TEST_CASE("the inverted file finds a descriptor again with one wrong bit in each word") {
  std::mt19937_64 bits(1);
  WordIndex index;
  std::vector<Descriptor> all(500);
  for (Descriptor& descriptor : all) {
    for (uint64_t& word : descriptor) word = bits();
    index.add(descriptor);
  }
  for (uint32_t i = 0; i < all.size(); ++i) {
    Descriptor seen = all[i];
    seen[0] ^= 1ull << 3 | 1ull << 17 | 1ull << 30 | 1ull << 45;
    bool found = false;
    index.look_up(seen, [&](uint32_t number) { found = found || number == i; });
    CHECK(found);
  }
}

TEST_CASE("a place is recognised from elsewhere, with another lens, rotated and in less light") {
  const Wall wall(1);
  PlaceMap map;
  const Rigid place = at({0, 0, 0});
  const uint64_t id = add(map, wall, place);
  REQUIRE(id != 0);
  struct Case {
    Rigid T;
    double focal_px;
    cv::Size size;
    double light;
  };
  for (const Case& c :
       {Case{at({0, 0, 0}), 500, {640, 480}, 1}, Case{at({0.4, -0.1, 0.3}, -8), 500, {640, 480}, 1},
        Case{at({0, 0, 1.0}), 500, {640, 480}, 1}, Case{at({0, 0, -1.5}), 500, {640, 480}, 1},
        Case{at({-0.3, 0.2, 0}, 10), 800, {960, 720}, 1}, Case{at({0.2, 0, 0.2}, 0, 90), 500, {480, 640}, 1},
        Case{at({0.2, 0, 0.2}, -5, 10), 500, {640, 480}, 0.3}}) {
    const auto seen = map.recognise(wall.picture(c.T, c.focal_px, c.size, c.light));
    REQUIRE(seen);
    CHECK(seen->key_frame == id);
    const Rigid truth = place.inverse() * c.T;
    CHECK((seen->T_k_c.p - truth.p).norm() < 0.03 + 0.01 * Wall::kAhead_m);  // the mark of the requirement
    CHECK(seen->T_k_c.q.angularDistance(truth.q) < 1 * kDegree);
    CHECK(squared_error(*seen, truth) < 22.5);  // 99.9 % of six degrees of freedom
  }
}

TEST_CASE("other walls are not recognised") {
  PlaceMap map;
  add(map, Wall(1), at({0, 0, 0}));
  for (unsigned seed = 2; seed < 22; ++seed) CHECK(!map.recognise(Wall(seed).picture(at({0, 0, 0}))));
  Picture nothing = Wall(1).picture(at({0, 0, 0}));
  nothing.grey = 128;
  CHECK(!map.recognise(nothing));
  CHECK(!PlaceMap().recognise(Wall(1).picture(at({0, 0, 0}))));
}

TEST_CASE("a place of which the map has a copy is not recognised: it might be either") {
  const Wall wall(1);
  PlaceMap map;
  add(map, wall, at({0, 0, 0}), {}, 0);
  const Picture query = wall.picture(at({0.2, 0, 0.1}));
  CHECK(map.recognise(query));
  const uint64_t copy = add(map, wall, at({0, 0, 0}), at({10, 0, 0}), 1);
  CHECK(!map.recognise(query));
  CHECK(map.recognise(query, [copy](const KeyFrame& frame) { return frame.id == copy; }));
  map.remove(copy);
  CHECK(map.recognise(query));
  CHECK(map.find(copy) == nullptr);
}

TEST_CASE("a flat picture is plausible and not accepted: it may hang anywhere") {
  const Wall flat(1, 0);
  PlaceMap map;
  add(map, flat, at({0, 0, 0}));
  const Picture query = flat.picture(at({0.2, 0, 0.1}));
  const QueryView view = view_of(query, map.parameters().features);
  const auto best = map.best_of(view, map.candidates(view));
  REQUIRE(best);
  CHECK(map.is_plausible(*best));
  CHECK(!map.is_accepted(*best));
  CHECK(!map.recognise(query));
}

TEST_CASE("landmarks between key frames lie where the wall is") {
  // The first has no earlier one: its landmarks are the front-end's, which the test leaves out of the second.
  const Wall wall(1);
  PlaceMap map;
  add(map, wall, at({0, 0, 0}));
  const Rigid second = at({0.4, 0, 0});
  const Picture picture = wall.picture(second);
  auto tracked = wall.landmarks(wall.picture(at({0, 0, 0})), at({0, 0, 0}));
  tracked.resize(40);
  for (Landmark& landmark : tracked) {
    landmark.p_c = second.inverse() * landmark.p_c;
    landmark.pixel = picture.lens.project(landmark.p_c.head<2>() / landmark.p_c.z());
  }
  // A published orientation that is off by 1.7 degrees: so would the distances be by a fifth, twice their 3 sigma.
  map.add(picture, tracked, second * Rigid{Quaterniond(Eigen::AngleAxisd(0.03, Vector3d::UnitY())), {}});
  REQUIRE(map.key_frames().size() == 2);
  size_t paired = 0, on_wall = 0;
  for (const KeptLandmark& landmark : map.key_frames()[1].landmarks) {
    if (landmark.id < 1ull << 63) continue;
    const Vector3d p = second * Eigen::Vector3f::Map(landmark.p_k.data()).cast<double>();
    ++paired;
    on_wall += std::abs(p.z() + 0.4 * std::abs(p.x()) - Wall::kAhead_m) < 3 * static_cast<double>(landmark.along_sigma)
                   ? 1
                   : 0;
  }
  CHECK(paired > 50);
  CHECK(static_cast<double>(on_wall) > 0.97 * static_cast<double>(paired));
}

TEST_CASE("a corner that would be much nearer or farther than the tracked landmarks beside it is another window") {
  std::vector<Landmark> tracked(5);
  const double distances[] = {10, 11, 12, 2, 40};
  for (size_t i = 0; i < tracked.size(); ++i) {
    const double aside = i < 3 ? 0.05 * static_cast<double>(i) : 0.6;  // the last two are elsewhere in the picture
    tracked[i].p_c = distances[i] * Vector3d(aside, 0, 1).normalized();
  }
  const auto is_kept = [&](double distance) {
    return is_as_far(distance * Vector3d(0.02, 0.02, 1).normalized(), tracked, ViewPairParameters());
  };
  CHECK(is_kept(7));
  CHECK(is_kept(18));
  CHECK_FALSE(is_kept(4));
  CHECK_FALSE(is_kept(25));
  CHECK_FALSE(is_as_far(Vector3d(0, 0, 5), {}, ViewPairParameters()));
}

TEST_CASE("the same pictures give the same recognition, and a stored map the same as the one it was made from") {
  const Wall wall(1);
  const auto made = [&] {
    PlaceMap map;
    add(map, wall, at({0, 0, 0})), add(map, wall, at({0.3, 0, 0}));
    return map;
  };
  const PlaceMap first = made(), second = made();
  const std::vector<uint8_t> bytes = bytes_of(first);
  CHECK(bytes == bytes_of(second));
  auto read = key_frames_of(bytes);
  REQUIRE(std::holds_alternative<std::vector<KeyFrame>>(read));
  PlaceMap restored;
  restored.restore(std::get<std::vector<KeyFrame>>(std::move(read)));
  CHECK(bytes_of(restored) == bytes);
  CHECK(restored.next_epoch() == 1);
  const Picture query = wall.picture(at({0.1, 0.1, 0.2}, 5));
  const auto a = first.recognise(query), b = restored.recognise(query);
  REQUIRE(a);
  REQUIRE(b);
  CHECK(a->T_k_c.p == b->T_k_c.p);
  CHECK(a->covariance == b->covariance);
}

TEST_CASE("damaged maps are refused") {
  PlaceMap map;
  add(map, Wall(1), at({0, 0, 0}));
  const std::vector<uint8_t> bytes = bytes_of(map);
  const auto is_refused = [](std::span<const uint8_t> some) {
    return std::holds_alternative<std::string>(key_frames_of(some));
  };
  for (size_t size = 0; size < bytes.size(); size += 1 + size / 50) CHECK(is_refused(std::span(bytes).first(size)));
  for (size_t i = 0; i < bytes.size(); i += 1 + i / 50) {
    std::vector<uint8_t> damaged = bytes;
    damaged[i] ^= 0x10;
    CHECK(is_refused(damaged));
  }
  std::vector<uint8_t> longer = bytes;
  longer.push_back(0);
  CHECK(is_refused(longer));
}

TEST_CASE("key frames are removed down to a size, those beside another first") {
  const Wall wall(1);
  PlaceMap map;
  std::vector<uint64_t> ids;
  for (const double x : {0.0, 0.02, 0.04, 1.0}) ids.push_back(add(map, wall, at({x, 0, 0})));
  map.thin(map.bytes());
  CHECK(map.key_frames().size() == 4);
  map.thin(map.bytes() / 2);
  REQUIRE(map.key_frames().size() == 2);
  CHECK(map.find(ids[3]));  // alone at its place
  CHECK(map.find(ids[2]));  // the newest of the others
}

TEST_CASE("two recognitions agree if the motion between their pictures fits") {
  Recognition a, b;
  a.covariance = b.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
  const Eigen::Matrix<double, 6, 6> motion = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
  const Rigid T_m_ka = at({1, 2, 3}, 30), T_m_kb = at({2, 2, 3}, 50), T_ca_cb = at({0.3, 0, 0}, 10);
  a.T_k_c = at({0.1, 0.2, 0}, 5);
  b.T_k_c = T_m_kb.inverse() * T_m_ka * a.T_k_c * T_ca_cb;
  CHECK(agree(a, T_m_ka, b, T_m_kb, T_ca_cb, motion) == Agreement::yes);
  CHECK(agree(b, T_m_kb, a, T_m_ka, T_ca_cb.inverse(), motion) == Agreement::yes);
  Recognition off = b;
  off.T_k_c.p += Vector3d(0, 0, 0.2);  // eight sigmas of 2.5 cm, with the drift between the key frames
  CHECK(agree(a, T_m_ka, off, T_m_kb, T_ca_cb, motion) == Agreement::no);
  off.covariance *= 1e4, off.T_k_c.p.z() += 2;  // a covariance excuses only so much
  CHECK(agree(a, T_m_ka, off, T_m_kb, T_ca_cb, motion) == Agreement::no);
  CHECK(agree(a, T_m_ka, a, T_m_ka, Rigid(), motion) == Agreement::not_apart);
}

TEST_CASE("a key frame is chosen after motion, rotation or with new landmarks, not at rest") {
  KeyFrameChooser chooser;
  std::vector<Landmark> landmarks(40);
  for (size_t i = 0; i < landmarks.size(); ++i) landmarks[i].id = i, landmarks[i].p_c = Vector3d(0, 0, 4);
  int64_t t_ns = 0;
  const auto next = [&](const Rigid& T) { return chooser.choose(t_ns += 1'000'000'000, T, landmarks); };
  CHECK(next(at({0, 0, 0})));
  CHECK(!next(at({0, 0, 0})));
  CHECK(!next(at({0.1, 0, 0})));
  CHECK(next(at({1, 0, 0})));
  CHECK(next(at({1, 0, 0}, 25)));
  for (size_t i = 0; i < 30; ++i) landmarks[i].id += 1000;
  CHECK(next(at({1, 0, 0}, 25)));
  CHECK(!chooser.choose(t_ns + 1000, at({5, 0, 0}), landmarks));  // too soon
  landmarks.resize(5);
  CHECK(!next(at({9, 0, 0})));  // nothing to recognise it by
}

TEST_SUITE_END();
