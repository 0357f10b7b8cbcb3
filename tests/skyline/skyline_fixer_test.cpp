// SPDX-License-Identifier: Apache-2.0
//
// When a picture gets a fix: poses, intervals, drift, failures, delay.
#include "plugins/fix/skyline/roof_survey.hpp"
#include "plugins/fix/skyline/skyline_fixer.hpp"
#include "tests/skyline/rendered_street.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline_fixer");

namespace {

constexpr int64_t kSecond = 1'000'000'000;
const Vector3d kPlace(3.2, -1.7, -1.5);
const std::vector<double> kRoofErrors = {3.5, -4, 3, -4, 3.5, -3};

std::optional<Fix> fix_in(const Outcome& outcome) {
  const Fix* fix = std::get_if<Fix>(&outcome);
  return fix ? std::optional(*fix) : std::nullopt;
}

/// A fixer for an upward camera in a street, with a picture from kPlace and one in which nothing is seen.
struct Street {
  TemporaryFolder folder;
  std::optional<SkylineFixer> fixer;
  cv::Mat seen = view_upwards(kPlace), blank{480, 640, CV_8UC1, cv::Scalar(70)};

  explicit Street(FixerConfig config = {}, const std::vector<double>& roofs = {}) {
    write_street(folder / "city.json", roofs);
    config.model = (folder / "city.json").string(), config.min_agreement = roofs.empty() ? 0.6 : 0.75;
    cv::randu(blank, 0, 90);
    fixer.emplace(config);
  }

  static PipelinePose pose(int64_t t_ns, const Vector3d& p_n = kPlace, double sigma_m = 1) {
    PipelinePose p{t_ns, p_n, Eigen::Quaterniond(0, 1, 0, 0)};
    p.has_position = p.is_of_camera = p.is_metric = true;
    p.horizontal_sigma_m = sigma_m, p.yaw_sigma_rad = 0.02, p.tilt_sigma_rad = 0.01;
    return p;
  }

  std::vector<Outcome> add(int64_t t_ns, const cv::Mat& picture) {
    CHECK(fixer->advance(t_ns).empty());
    REQUIRE_FALSE(fixer->busy());
    REQUIRE(fixer->is_due(t_ns));
    return fixer->add_picture({.t_ns = t_ns, .grey = picture, .mask = {}, .chroma = {}, .lens = kLens});
  }

  /// What becomes of the picture in processing, at frames that follow each other in 50 ms.
  Outcome finish(int64_t t_ns) {
    while (fixer->busy())
      if (const auto done = fixer->advance(t_ns += kSecond / 20); !done.empty()) return done.front();
    FAIL("no outcome");
    return Rejection{};
  }

  /// The same for a picture that comes with its pose.
  Outcome fix(const PipelinePose& pose, const cv::Mat& picture) {
    CHECK(fixer->add_pose(pose).empty());
    const auto at_once = add(pose.t_ns, picture);
    return at_once.empty() ? finish(pose.t_ns) : at_once.front();
  }

  /// The fix of such a picture, if it gets one.
  std::optional<Fix> fixed(const PipelinePose& pose, const cv::Mat& picture) { return fix_in(fix(pose, picture)); }
};

std::string reason_of(const Outcome& outcome) {
  const auto* rejection = std::get_if<Rejection>(&outcome);
  return rejection ? kReasonNames[rejection->first] : "none";
}

}  // namespace

TEST_CASE("a picture waits for its pose, and the next one is due after the interval") {
  Street street({.min_sigma = 3});
  CHECK(street.add(kSecond, street.seen).empty());
  CHECK_FALSE(street.fixer->is_due(kSecond + 498'000'000));
  CHECK(street.fixer->is_due(kSecond + 500'000'000));
  CHECK(street.fixer->add_pose(Street::pose(kSecond - 10'000'000)).empty());
  CHECK_FALSE(street.fixer->busy());
  CHECK(street.fixer->add_pose(Street::pose(kSecond)).empty());
  CHECK(street.fixer->busy());
  const auto fix = required(fix_in(street.finish(kSecond)));
  CHECK(fix->t_ns == kSecond);
  CHECK(fix->has_slant);
  CHECK_FALSE(fix->has_height);
  CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.6);
  CHECK(fix->match.covariance.diagonal().minCoeff() > 3 * 3);
  CHECK(fix->match.second_best_ratio >= 0.01);
}

TEST_CASE("a picture without a pose of the camera at its time gets no fix, and a later one replaces it") {
  Street street;
  CHECK(street.add(kSecond, street.seen).empty());
  const auto replaced = street.add(2 * kSecond, street.seen);
  REQUIRE(replaced.size() == 1);
  CHECK(reason_of(replaced[0]) == "prior");
  const auto passed = street.fixer->add_pose(Street::pose(2 * kSecond + 1));
  REQUIRE(passed.size() == 1);
  CHECK(reason_of(passed[0]) == "prior");
  auto of_body = Street::pose(3 * kSecond);
  of_body.is_of_camera = false;
  CHECK(reason_of(street.fix(of_body, street.seen)) == "prior");
  CHECK(reason_of(street.fix(Street::pose(4 * kSecond), street.blank)) == "sky");
}

TEST_CASE(
    "a pose that is off by more than the search radius is not matched: by its sigma, or by the path since a fix") {
  Street street;
  const auto reason_at = [&](int64_t t_ns, double sigma_m, double path_m) {
    auto pose = Street::pose(t_ns, kPlace, sigma_m);
    pose.path_m = path_m;
    return reason_of(street.fix(pose, street.seen));
  };
  CHECK(reason_at(kSecond, 1001, 0) == "prior");
  CHECK(reason_at(2 * kSecond, 13.4, 0) == "prior");  // three sigmas are 40.2 m
  CHECK(reason_at(3 * kSecond, 1, 670) == "prior");   // 670 m with a heading sigma of 0.02: three sigmas are 40.2 m
  CHECK(reason_at(4 * kSecond, 1, 660) == "none");
  CHECK(reason_at(6 * kSecond, 1, 1325) == "none");  // 665 m after the fix
}

TEST_CASE("a fix that comes too late for the estimators refers to the newest pose") {
  Street street;
  CHECK(street.fixer->add_pose(Street::pose(kSecond)).empty());
  CHECK(street.add(kSecond, street.seen).empty());
  const Vector3d walked(3, -4, 0);
  CHECK(street.fixer->add_pose(Street::pose(3 * kSecond + 600'000'000, kPlace + walked)).empty());
  const auto fix = required(fix_in(street.finish(3 * kSecond + 600'000'000)));
  CHECK(fix->t_ns == 3 * kSecond + 600'000'000);
  CHECK_FALSE(fix->has_slant);
  CHECK((fix->match.p_n - kPlace - walked).head<2>().norm() < 0.8);
}

TEST_CASE("a pose that is off by more than its sigma is searched for after four failures") {
  Street street({.radius = 20});
  const Vector3d off = kPlace + Vector3d(-13, 9, 0);
  int failures = 0;
  for (; failures < 12; ++failures) {
    const Outcome outcome = street.fix(Street::pose((1 + failures) * kSecond, off, 0.2), street.seen);
    if (const Fix* fix = std::get_if<Fix>(&outcome)) {
      CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.6);
      break;
    }
    const auto& text = std::get<Rejection>(outcome).second;
    CAPTURE(failures);
    CHECK_MESSAGE((text == "lost: more pictures must agree") == (failures >= 4), text);
  }
  CHECK(failures == Between{4, 12});
}

TEST_CASE("where the model's roofs are metres off they are surveyed, and the next pictures fit the corrected model") {
  Street street({}, kRoofErrors);
  int second = 0;
  const auto fix_at = [&](const Vector3d& place) {
    return street.fix(Street::pose(2 * ++second * kSecond, place + Vector3d(0.8, -0.5, 0)), view_upwards(place));
  };
  CHECK(reason_of(fix_at(kPlace)) == "agreement");
  const auto surveyed = required(fix_in(fix_at(kPlace)));
  CHECK(surveyed->match.roofs.size() == std::size(kStreet));
  CHECK_FALSE(surveyed->has_slant);
  CHECK(surveyed->surveyed == "6 buildings are up to 4.2 m higher or lower than in the model");
  CHECK((surveyed->match.p_n - kPlace).head<2>().norm() < 0.5);
  for (int k = 1; k < 6; ++k) {
    const Vector3d place = kPlace + k * Vector3d(0.5, 0.1, 0);
    const Outcome later = fix_at(place);
    CAPTURE(k);
    CAPTURE(reason_of(later));
    const auto fix = required(fix_in(later));
    CHECK(fix->has_slant);
    CHECK(fix->surveyed.empty());
    CHECK((fix->match.p_n - place).head<2>().norm() < 0.5);
  }
}

TEST_CASE("a survey from a pose that is off by more than its sigma finds the place or none") {
  int surveys = 0;
  for (const Vector3d& off : {Vector3d(2, -1.5, 0), Vector3d(-8, 0, 0), Vector3d(7, -7, 0), Vector3d(2, 12, 0)}) {
    CAPTURE(off.transpose());
    Street street({}, kRoofErrors);
    for (int second = 1; second <= 5; ++second) {
      const auto fix = street.fixed(Street::pose(second * kSecond, kPlace + off, 0.3), street.seen);
      if (!fix || fix->has_slant) continue;
      ++surveys;
      const Eigen::Vector2d d = (fix->match.p_n - kPlace).head<2>();
      CHECK(d.dot(fix->match.covariance.inverse() * d) < 9);
      CHECK(d.norm() < 1.5);
    }
  }
  CHECK(surveys > 0);
}

TEST_CASE("a pose without an uncertainty is surveyed like another") {
  for (const double yaw_sigma : {0.0, 3.0}) {
    CAPTURE(yaw_sigma);
    Street street({}, kRoofErrors);
    bool fixed = false;
    for (int k = 1; k <= 3; ++k) {
      auto pose = Street::pose(2 * k * kSecond, kPlace, 0);
      pose.yaw_sigma_rad = yaw_sigma;
      const auto fix = street.fixed(pose, street.seen);
      if (!fix) continue;
      fixed = true;
      CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.5);
    }
    CHECK(fixed);
  }
}

TEST_CASE("a survey has the inclination of the vertical lines where that is wanted") {
  Street street({.inclination = "vanishing_point"}, kRoofErrors);
  for (int y = 0; y < street.seen.rows; ++y)  // walls with vertical stripes
    for (int x = 0; x < street.seen.cols; ++x)
      if (Vector3d ray; street.seen.at<uint8_t>(y, x) < 150 && ray_of(kLens, {double(x), double(y)}, 1.5, ray))
        street.seen.at<uint8_t>(y, x) = std::fmod(std::atan2(ray.y(), ray.x()) * 20 + 100, 2) < 1 ? 40 : 95;
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(0.05, Vector3d(0.8, 0.6, 0)));
  int surveyed = 0;
  for (int second = 2; second <= 8; second += 2) {
    auto pose = Street::pose(second * kSecond, kPlace + Vector3d(0.8, -0.5, 0));
    pose.q_n_c = tilted * pose.q_n_c;
    const auto fix = street.fixed(pose, street.seen);
    if (!fix || fix->has_slant) continue;
    ++surveyed;
    const Eigen::Vector2d d = (fix->match.p_n - kPlace).head<2>();
    // By a tilt of 2.9 degrees roofs of 50 m would move by 2.5 m.
    CHECK(d.dot(fix->match.covariance.inverse() * d) < 9);
    CHECK(d.norm() < 1.2);
  }
  CHECK(surveyed > 0);
}

TEST_CASE("fixes that use surveyed roofs have the survey's error") {
  Street street({}, kRoofErrors);
  std::optional<Match> surveyed;
  std::vector<Match> later;
  for (int second = 2; second <= 16 && later.size() < 3; second += 2) {
    const auto fix = street.fixed(Street::pose(second * kSecond, kPlace), street.seen);
    if (fix && !fix->has_slant)
      surveyed = fix->match;
    else if (fix && surveyed)
      later.push_back(fix->match);
  }
  REQUIRE(later.size() == 3);
  const double survey_m2 = surveyed->covariance.trace() - 2 * 0.2 * 0.2;  // without min_sigma
  for (const Match& match : later) {
    CHECK(match.covariance.trace() > survey_m2);
    CHECK(match.yaw_sigma_rad > surveyed->yaw_sigma_rad);
    CHECK(match.height_sigma_m > surveyed->height_sigma_m);
    CHECK(match.second_best_ratio >= surveyed->second_best_ratio);
  }
}

TEST_CASE("a fix has the errors of the surveys whose roofs it has used, by their share") {
  RoofSurvey survey{City({})};
  Match first{}, second{}, fix{};
  first.covariance = 0.4 * Eigen::Matrix2d::Identity(), first.yaw_sigma_rad = 0.04, first.second_best_ratio = 0.003;
  second.covariance = 0.8 * Eigen::Matrix2d::Identity(), second.height_sigma_m = 0.2;
  fix.covariance.setZero(), fix.second_best_ratio = 0.001;
  first.roofs = {{0, 1.0, 30}, {1, 2.0, 5}}, second.roofs = {{2, -1.0, 10}};
  survey.adopt(first), survey.adopt(second);
  fix.roofs = {{0, 0, 25}, {1, 0, 25}, {2, 0, 50}};  // 5 directions do not give building 1 a height
  survey.add_error(fix);
  CHECK(fix.covariance(0, 0) == doctest::Approx(0.25 * 0.4 + 0.5 * 0.8));
  CHECK(fix.yaw_sigma_rad == doctest::Approx(0.5 * 0.04));
  CHECK(fix.height_sigma_m == doctest::Approx(std::sqrt(0.5) * 0.2));
  CHECK(fix.second_best_ratio == 0.003);
}

TEST_CASE("a second survey of the same roofs replaces the first, and none is left once they are forgotten") {
  Street street({}, kRoofErrors);
  const City model(read_city_outline((street.folder / "city.json").string(), {}));
  City city = model;
  RoofSurvey survey(model);
  SkyDetector detector;
  const PhotographPrior prior{.p_n = kPlace + Vector3d(0.8, -0.5, 0),
                              .q_n_c = Street::pose(0).q_n_c,
                              .sigma_m = 1,
                              .height_sigma_m = 0.1,
                              .yaw_sigma_rad = 0.02,
                              .tilt_sigma_rad = 0.01,
                              .eye_m = std::nullopt};
  const Picture picture{.t_ns = 0, .grey = street.seen, .mask = {}, .chroma = {}, .lens = kLens};
  const auto edges = detector.find(picture, prior.q_n_c.conjugate(), false);
  uint64_t work = 0;
  const Spend spend = [&](uint64_t amount) { work += amount; };
  std::vector<Match> matches;
  for (int k = 0; k < 2; ++k) {
    const auto match = required(survey.match(edges, prior, spend));
    matches.push_back(*match);
    survey.adopt(*match), survey.correct_roofs(city, spend);
    std::vector<double> heights(std::size(kStreet)), expected;
    for (const Edge& e : city.edges())
      if (e.object >= 0)
        heights[static_cast<size_t>(e.object)] = std::max(heights[static_cast<size_t>(e.object)], -e.from.z());
    for (const Box& box : kStreet) expected.push_back(box.height);
    std::sort(heights.begin(), heights.end()), std::sort(expected.begin(), expected.end());
    for (size_t i = 0; i < expected.size(); ++i) CHECK(std::abs(heights[i] - expected[i]) < 1);
  }
  CHECK(matches[0].covariance == matches[1].covariance);
  const uint64_t before = work;
  survey.correct_roofs(city, spend);
  CHECK(work == before);  // nothing has changed
  survey.forget(), survey.correct_roofs(city, spend);
  CHECK(work > before);
  for (size_t i = 0; i < model.edges().size(); ++i) CHECK(city.edges()[i].from == model.edges()[i].from);
}

TEST_CASE("roofs that were surveyed are as in the model again once the fixer is lost") {
  Street street({}, kRoofErrors);
  const auto model = street.fixer->city().edges();
  const auto changed = [&] {
    const auto& now = street.fixer->city().edges();
    return !std::equal(now.begin(), now.end(), model.begin(), model.end(),
                       [](const Edge& x, const Edge& y) { return x.from == y.from; });
  };
  int second = 0;
  const auto fixed = [&](const cv::Mat& picture) {
    return std::holds_alternative<Fix>(street.fix(Street::pose(5 * ++second * kSecond, kPlace), picture));
  };
  while (second < 3) fixed(street.seen);
  CHECK(changed());
  cv::Mat mirrored;
  cv::flip(street.seen, mirrored, 1);
  for (int k = 0; k < 4; ++k) CHECK_FALSE(fixed(mirrored));
  CHECK(changed());
  CHECK_FALSE(fixed(mirrored));
  CHECK_FALSE(changed());
}

TEST_CASE("every second failed picture is surveyed, with a heading or without") {
  for (const double yaw_sigma : {0.02, 3.0}) {
    CAPTURE(yaw_sigma);
    Street street({}, kRoofErrors);
    cv::Mat mirrored;
    cv::flip(street.seen, mirrored, 1);
    const auto frames_of = [&](int second) {
      auto pose = Street::pose(second * kSecond);
      pose.yaw_sigma_rad = yaw_sigma;
      CHECK(street.fixer->add_pose(pose).empty());
      CHECK(street.add(pose.t_ns, mirrored).empty());
      int frames = 0;
      for (bool done = false; !done; ++frames) {
        const auto outcomes = street.fixer->advance(pose.t_ns += kSecond / 20);
        done = !outcomes.empty();
        if (done) CHECK(std::holds_alternative<Rejection>(outcomes.front()));
      }
      return frames;
    };
    const int first = frames_of(20), second = frames_of(40), third = frames_of(60);
    CHECK(second > 1.5 * first);
    CHECK(second > 1.5 * third);
  }
}

TEST_CASE("a fixer that goes during a survey ends it") {
  Street street({}, kRoofErrors);
  CHECK(std::holds_alternative<Rejection>(street.fix(Street::pose(2 * kSecond, kPlace), street.seen)));
  CHECK(street.fixer->add_pose(Street::pose(10 * kSecond)).empty());
  CHECK(street.add(10 * kSecond, street.seen).empty());
  for (int k = 1; k <= 10; ++k) CHECK(street.fixer->advance(10 * kSecond + k * kSecond / 20).empty());
  CHECK(street.fixer->busy());
  street.fixer.reset();
}

TEST_CASE("without a survey a model whose roofs are metres off gives no fix") {
  Street street({.survey = false}, kRoofErrors);
  for (int second = 2; second < 10; second += 2) {
    const Outcome outcome = street.fix(Street::pose(second * kSecond, kPlace + Vector3d(0.8, -0.5, 0)), street.seen);
    CHECK(std::holds_alternative<Rejection>(outcome));
  }
}

TEST_CASE("without a city there is no fixer, nor without a database where it is needed or the model must be geodetic") {
  CHECK_THROWS_WITH(SkylineFixer{FixerConfig{}},
                    "model: expected a CityJSON or CityGML file of the city, or a database in `skylines`");
  FixerConfig config;
  config.model = "city.json", config.start_known = false;
  CHECK_THROWS_WITH(SkylineFixer{config}, "start_known: false wants a database in `skylines`");
  config.skylines = "city.skylines", config.geodetic = true;
  CHECK_THROWS_WITH(SkylineFixer{config}, "geodetic: a database lies along the model's grid; give model_origin");
}
