// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "plugins/fix/known_object/finder.hpp"
#include "plugins/fix/known_object/object_fixer.hpp"
#include "plugins/fix/known_object/read_objects.hpp"
#include "sdk/host/base/geodesy.hpp"
#include "sdk/tools/simulation/poster.hpp"
#include "tests/plugins/known_object_scene.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::known_object_tests;
using namespace odograph::known_object;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("known_object");

namespace {

constexpr int64_t kFrame = 100'000'000;

/// A camera that stands in front of the poster; the pipeline's origin is elsewhere, by an offset.
struct Walker {
  PlaneObject object = poster();
  Scene scene{object, 5, 20 * kDegree};
  odo_calibration camera = calibration(0);
  cv::Mat grey = frame_of({flat(object, object.picture, scene.pose(object))}, camera);

  std::unique_ptr<ObjectFixer> fixer() const {
    Finder::Parameters finder;
    finder.search_interval_s = 0;
    auto result = std::make_unique<ObjectFixer>(ObjectFixer::Parameters{}, finder, SightingValidator::Parameters{},
                                                std::vector{object});
    result->set_mount(Eigen::Quaterniond::Identity(), Vector3d::Zero());
    return result;
  }
  PipelinePose pose(int64_t t_ns, const Vector3d& offset_n = Vector3d::Zero()) const {
    PipelinePose p{t_ns, Eigen::Quaterniond(scene.R_n_c), scene.p_n + offset_n};
    p.is_of_camera = p.is_metric_position = true;
    p.tilt_sigma_rad = kDegree, p.yaw_sigma_rad = 3 * kDegree, p.horizontal_sigma_m = 1, p.vertical_sigma_m = 0.3;
    return p;
  }
  std::vector<Estimate> frame(ObjectFixer& fixer, int64_t t_ns) const {
    return fixer.add_frame(t_ns, grey, {}, lens_of(camera));
  }
};

}  // namespace

TEST_CASE("a sighting waits for the pose that follows its frame; one in a long gap between poses gives no fix") {
  const Walker walker;
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  size_t fixes = 0;
  for (int k = 0; k < 10; ++k) {
    CHECK(walker.frame(fixer, k * kFrame + kFrame / 2).empty());
    fixes += fixer.add_pose(walker.pose(k * kFrame)).size();
  }
  CHECK(fixes > 0);
  // The next pose is two seconds later: no pose is interpolated over that long.
  CHECK(walker.frame(fixer, 10 * kFrame).empty());
  CHECK(fixer.add_pose(walker.pose(30 * kFrame)).empty());
}

TEST_CASE("a fix is where the camera stands, to centimetres") {
  const Walker walker;
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  std::vector<Estimate> fixes;
  for (int k = 0; k < 10; ++k) {
    fixer.add_pose(walker.pose(k * kFrame));
    for (const Estimate& e : walker.frame(fixer, k * kFrame)) fixes.push_back(e);
  }
  REQUIRE_FALSE(fixes.empty());
  CHECK((fixes.back().p_n - walker.scene.p_n).norm() < 0.05);
}

TEST_CASE("the first fix aligns n with the objects, and from then on a pose elsewhere is rejected") {
  Walker walker;
  walker.object.place.geodetic = true;  // and n's origin is unknown
  walker.object.place.latitude_rad = 0.84, walker.object.place.longitude_rad = 0.04;
  const Vector3d offset_n(200, -80, 3);
  const auto run = [&](ObjectFixer& fixer, int first, const Vector3d& offset) {
    size_t fixes = 0;
    for (int k = first; k < first + 12; ++k) {
      fixer.add_pose(walker.pose(k * kFrame, offset));
      fixes += walker.frame(fixer, k * kFrame).size();
    }
    return fixes;
  };
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  CHECK(run(fixer, 0, offset_n) > 0);
  CHECK(run(fixer, 30, offset_n) > 0);
  CHECK(run(fixer, 60, offset_n + Vector3d(30, 0, 0)) == 0);
  fixer.reset();
  CHECK(run(fixer, 90, Vector3d(-5, 7, 0)) > 0);
}

TEST_CASE("objects in n and geodetic ones need n's origin") {
  const Walker walker;
  PlaneObject geodetic = walker.object;
  geodetic.id = "another", geodetic.place.geodetic = true;
  CHECK_THROWS_AS(ObjectFixer({}, {}, {}, {walker.object, geodetic}), std::runtime_error);
  ObjectFixer::Parameters parameters;
  parameters.origin = {0.84, 0.04, 100};
  CHECK_NOTHROW(ObjectFixer(parameters, {}, {}, {walker.object, geodetic}));
}

TEST_CASE("a poster and a tag beside a simulated walk are at their surveyed positions") {
  const TemporaryFolder folder;
  Scenario s;
  s.route = {{0, 0, 0}, {5, 0, 0}};
  s.objects = {{9, 1.0, 1.6, 1.8, "poster", 0.6}, {9, -0.8, 1.6, 0.6}};
  s.world.pedestrians = 0, s.world.cars = 0;
  s.camera.rate_hz = 2, s.camera.row_time_s = 0;
  const Recording recording = recorded(s, 2, folder / "walk.odo");
  REQUIRE(write_known_objects(s, 2, folder / "survey").ok());
  const std::vector<PlaneObject> objects = read_objects(folder / "survey" / "objects.yaml");
  REQUIRE(objects.size() == 2);
  CHECK(objects[0].id == "poster 0");
  CHECK(std::abs(objects[0].width_m - 1.08) < 1e-3);
  Geodesy geodesy;
  geodesy.set_origin(kSimulatedOrigin);
  RollingLens lens;
  lens.camera.fx = lens.camera.fy = s.camera.focal_px, lens.camera.cx = 319.5, lens.camera.cy = 239.5;
  lens.width = s.camera.width, lens.height = s.camera.height;
  Finder finder({}, objects);
  std::array<int, 2> seen{};
  size_t frame_index = 0;
  for_each_picture(recording, [&](const odo_frame& frame) {
    const StampedPose& truth = recording.truth[frame_index++];
    const cv::Mat grey(480, 640, CV_8U, const_cast<uint8_t*>(frame.planes[0].data),
                       static_cast<size_t>(frame.planes[0].row_stride));
    for (const Sighting& sighting : finder.find(truth.t_ns, grey, {}, lens, {})) {
      const PlaneObject& o = objects[sighting.object];
      const auto middle = geodesy.from_geodetic({o.place.latitude_rad, o.place.longitude_rad, o.place.height_m});
      const Vector3d p_c = truth.q.conjugate() * (Vector3d(middle.data()) - truth.p);
      CAPTURE(o.id);
      CHECK((sighting.poses[0].pose.t_c_o - p_c).norm() < 0.02 * p_c.norm());
      ++seen[sighting.object];
    }
  });
  CHECK(seen[0] >= 3);
  CHECK(seen[1] >= 3);
}

TEST_CASE("survey errors of the corners shift and rotate the camera as the covariance states") {
  using namespace known_object_tests;
  PlaneObject o = poster();
  o.sigma_m = 0.02;
  SightingValidator::Parameters p;
  p.confirmations = 1, p.focal_sigma = 0, p.pixel_sigma = 1e-3;
  for (const double oblique_rad : {-0.6, 0.0, 0.9}) {
    CAPTURE(oblique_rad);
    const known_object_tests::Scene scene(o, 4, oblique_rad);
    Sighting sighting = sighting_of(scene, o, 0, -1);
    sighting.poses[0].information *= 1e6;
    const auto told = required(SightingValidator(p).validate(sighting, o, lens_of(calibration(0)), scene.prior()));
    Random random(5, 1);
    Eigen::Matrix<double, 3, 4> stated, true_o;
    const auto corners = o.corners_o();
    for (int k = 0; k < 4; ++k) stated.col(k) = corners[static_cast<size_t>(k)];
    const Vector3d p_o = o.place.R_n_o.transpose() * (scene.p_n - o.place.p_n);
    Matrix3d position = Matrix3d::Zero(), rotation = Matrix3d::Zero();
    constexpr int kSurveys = 4000;
    for (int i = 0; i < kSurveys; ++i) {
      for (int k = 0; k < 12; ++k) true_o(k) = stated(k) + o.sigma_m * random.normal();
      const Eigen::Isometry3d T(Eigen::umeyama(stated, true_o, false));
      const Eigen::AngleAxisd turned(T.linear());
      const Vector3d off = o.place.R_n_o * (T * p_o - p_o), theta = o.place.R_n_o * (turned.angle() * turned.axis());
      position += off * off.transpose() / kSurveys, rotation += theta * theta.transpose() / kSurveys;
    }
    CHECK((told->covariance_n - position).norm() < 0.1 * position.norm());  // 4000 of them: 3 %
    CHECK((told->orientation_covariance_n - rotation).norm() < 0.1 * rotation.norm());
  }
}

namespace {

std::string why(const std::filesystem::path& file) {
  return reason_of([&] { read_objects(file); });
}

}  // namespace

TEST_CASE("YAML and GeoJSON give the same object, by its corners and by its centre") {
  const TemporaryFolder folder;
  cv::imwrite((folder / "p.png").string(), poster_picture(1, 1, {60, 90}));
  const double latitude = 47.2, longitude = -1.55, height = 20;
  Geodesy earth;
  earth.set_origin({latitude * kDegree, longitude * kDegree, height});
  // It faces east: the reader looks west, right is north.
  const Vector3d corners[] = {{-0.6, 0, 0.9}, {0.6, 0, 0.9}, {0.6, 0, -0.9}, {-0.6, 0, -0.9}};
  std::string yaml = "odograph_objects: 1\nobjects:\n  - id: p\n    picture: p.png\n    corners:\n", ring;
  for (int k = 0; k < 5; ++k) {
    const Vector3d& c = corners[k % 4];
    const auto g = earth.to_geodetic({c.x(), c.y(), c.z()});
    char text[200];
    std::snprintf(text, sizeof text, "%.10f, %.10f", g[0] / kDegree, g[1] / kDegree);
    if (k < 4) yaml += std::string("      - [") + text + ", " + std::to_string(g[2]) + "]\n";
    std::snprintf(text, sizeof text, "%s[%.10f, %.10f, %.5f]", k ? ", " : "", g[1] / kDegree, g[0] / kDegree, g[2]);
    ring += text;
  }
  const std::string feature = "{\"type\": \"FeatureCollection\", \"features\": [{\"type\": \"Feature\", ";
  write_text(folder / "o.yaml", yaml);
  write_text(folder / "o.geojson", feature +
                                       "\"properties\": {\"id\": \"p\", \"picture\": \"p.png\"}, \"geometry\": "
                                       "{\"type\": \"Polygon\", \"coordinates\": [[" +
                                       ring + "]]}}]}");
  write_text(folder / "point.json",
             feature +
                 "\"properties\": {\"id\": \"p\", \"picture\": \"p.png\", \"facing_deg\": 90, \"width\": 1.2, "
                 "\"height\": 1.8}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [-1.55, 47.2, 20]}}]}");
  Matrix3d axes;
  axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // right is north, down is down, into the wall is west
  for (const char* name : {"o.yaml", "o.geojson", "point.json"}) {
    CAPTURE(name);
    const auto objects = read_objects(folder / name);
    REQUIRE(objects.size() == 1);
    const PlaneObject& o = objects.front();
    CHECK(o.place.geodetic);
    CHECK((o.place.R_n_o - axes).norm() < 1e-3);
    CHECK(o.width_m == doctest::Approx(1.2).epsilon(1e-4));
    CHECK(o.height_m == doctest::Approx(1.8).epsilon(1e-4));
    CHECK(std::abs(o.place.latitude_rad / kDegree - latitude) < 1e-8);
    CHECK(std::abs(o.place.longitude_rad / kDegree - longitude) < 1e-8);
    CHECK(std::abs(o.place.height_m - height) < 1e-3);
    CHECK(o.picture.cols == 60);
  }
}

TEST_CASE("an error in a file of objects is reported with the object") {
  const TemporaryFolder folder;
  const std::string head = "odograph_objects: 1\nobjects:\n  - ";
  const auto says = [&](const std::string& text, const std::string& expected) {
    write_text(folder / "o.yaml", text);
    const std::string said = why(folder / "o.yaml");
    CHECK_MESSAGE(contains(said, expected), said);
  };
  const std::string square = "corners_n: [[5, 0, 0], [5, 1, 0], [5, 1, -1], [5, 0, -1]]";
  says("", "empty or unreadable");
  says("objects: []", "expected 'odograph_objects: 1'");
  says("odograph_objects: 1\nobjects: []", "expected 1 to 1000 objects");
  says(head + "{tag: 3, " + square + "}", "object 1: id: expected a name");
  says(head + "{id: a, " + square + "}", "expected either picture or tag");
  says(head + "{id: a, tag: 3, family: 12h1, " + square + "}", "family '12h1' is unknown");
  says(head + "{id: a, tag: 100000, " + square + "}", "has no tag 100000");
  says(head + "{id: a, picture: none.png, " + square + "}", "none.png");
  says(head + "{id: a, tag: 3, corners_n: [[5, 0, 0], [5, 1, 0], [5, 2, -1], [5, 0, -1]]}", "do not form a rectangle");
  says(head + "{id: a, tag: 3, corners_n: [[5, 0, 0], [5, 1, 0], [5, 1, -1]]}", "corners: expected four");
  says(head + "{id: a, tag: 3, " + square + "}\n  - {id: a, tag: 4, " + square + "}", "the id 'a' occurs twice");
  says("a: &x [1]\nb: *x", "line 2, column 4: aliases are not supported");
  says("a: 1\na: 2", "the key 'a' occurs twice");
  const std::string deep = std::string(100, '[') + std::string(100, ']');
  says("a: " + deep, "more than 64 levels");
  write_text(folder / "o.json", "{\"type\": \"FeatureCollection\", \"features\": [{\"properties\": {}}]}");
  CHECK(contains(why(folder / "o.json"), "object 1: expected a geometry"));
  CHECK(why(source("tests/data/objects.yaml")).empty());
}
