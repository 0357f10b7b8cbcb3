// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/vanishing_point.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("vanishing_point");

namespace {

constexpr double kDegree = std::numbers::pi / 180;

double apart_deg(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree; }

/// Upright edges around a camera that looks up, each with an error of half a pixel at f = 200, and lines in any
/// direction.
std::vector<SeenLine> lines_around(Random& random, const Vector3d& up_c, int upright, int other) {
  std::vector<SeenLine> lines;
  const auto direction = [&] { return Vector3d{random.normal(), random.normal(), random.normal()}.normalized(); };
  const auto line = [&](Vector3d a, Vector3d b) {
    a = (a + 0.0025 * direction()).normalized(), b = (b + 0.0025 * direction()).normalized();
    lines.push_back({a.cross(b).normalized(), std::asin(a.cross(b).norm())});
  };
  for (int i = 0; i < upright; ++i) {
    const Vector3d aside = up_c.cross(direction()).normalized();
    const double from = random.uniform(0.3, 0.8), to = from + random.uniform(0.1, 0.5);
    line(std::cos(from) * up_c + std::sin(from) * aside, std::cos(to) * up_c + std::sin(to) * aside);
  }
  for (int i = 0; i < other; ++i) {
    const Vector3d a = (up_c + 0.8 * direction()).normalized();
    line(a, (a + 0.3 * direction()).normalized());
  }
  return lines;
}

}  // namespace

TEST_CASE("upright lines give the zenith among as many others, consistently with its sigma") {
  Random random(5, 1);
  double normalised = 0;
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3d up_c = Vector3d{0.1 * random.normal(), 0.1 * random.normal(), 1}.normalized();
    const Vector3d prior_c = (up_c + 0.03 * Vector3d{random.normal(), random.normal(), 0}).normalized();
    const auto zenith = vanishing_zenith(lines_around(random, up_c, 40, 40), prior_c, {});
    if (!zenith) continue;
    ++found;
    CHECK(apart_deg(zenith->up_c, up_c) < 1.0);
    normalised += std::pow(apart_deg(zenith->up_c, up_c) * kDegree / zenith->sigma_rad, 2) / 2;
  }
  CHECK(found > 180);
  CHECK(normalised / found < 1.5);
}

TEST_CASE("a picture without upright lines gives no zenith") {
  Random random(6, 1);
  int told = 0;
  for (int i = 0; i < 100; ++i)
    told += vanishing_zenith(lines_around(random, Vector3d::UnitZ(), 3, 40), Vector3d::UnitZ(), {}).has_value();
  CHECK(told < 10);
  CHECK_FALSE(vanishing_zenith({}, Vector3d::UnitZ(), {}));
}

TEST_CASE("pitch and roll by vanishing points in pictures of real cities are within limits" *
          doctest::test_suite("vanishing_point_data")) {
  const auto folder = data_or_skip("city");
  if (folder.empty()) return;
  const TemporaryFolder made;
  struct Drive {
    const char *model, *origin, *points;
  };
  for (const Drive& drive :
       {Drive{"delft.city.json", "84942.468 m, 447476.999 m, -0.15 m", "[0, 0, 0], [0, -19, 0], [10, -30, 0]"},
        Drive{"linz.city.json", "-13.759 m, -300.628 m, 256.601 m", "[0, 0, 0], [0, -40, 0]"}}) {
    for (const char* lens : {"model: kannala_brandt, focal: 200 px", "focal: 400 px"}) {
      {
        std::ofstream out(made / "drive.yaml");
        out << "odograph_scenario: 1\ncarrier: car\nvehicle: {speed: 30 km/h}\nworld:\n  type: city\n  model: "
            << (folder / drive.model).string() << "\n  model_origin: [" << drive.origin
            << "]\nwalker: {stand: 0.5 s}\nroute:\n  corner: 5 m\n  points: [" << drive.points << "]\ncamera: {" << lens
            << ", exposure: 3 ms}\n";
      }
      const auto scenario = required(read_scenario((made / "drive.yaml").string()));
      const Recording recording = recorded(*scenario, 3, made / "drive.odo");
      Random random(9, 2);
      std::vector<double> errors;
      size_t pictures = 0, beyond = 0;
      CalibratedCamera camera;
      cv::Mat converted;
      for (const RecordedMessage& message : recording.messages) {
        if (message.message.header().type == ODO_TYPE_CALIBRATION)
          camera.take(reinterpret_cast<const odo_calibration&>(message.message.header()));
        if (message.message.header().type != ODO_TYPE_FRAME) continue;
        const auto frame = required(load_frame(message));
        const auto at = std::find_if(recording.truth.begin(), recording.truth.end(),
                                     [&](const StampedPose& p) { return p.t_ns == frame->header.t_ns; });
        if (at != recording.truth.end()) {
          ++pictures;
          const cv::Mat grey = grey_of(*frame, converted);
          const Vector3d up_c = at->q.conjugate() * -Vector3d::UnitZ();
          const Vector3d prior_c = (up_c + 0.02 * Vector3d{random.normal(), random.normal(), 0}).normalized();
          if (const auto zenith = vanishing_zenith(lines_of(grey, {}, camera.lens_of(*frame), {}), prior_c, {})) {
            errors.push_back(apart_deg(zenith->up_c, up_c));
            beyond += errors.back() * kDegree > 3.44 * zenith->sigma_rad;  // 99.73 % in two dimensions
          }
        }
        frame->loan.release(frame->loan.owner);
      }
      REQUIRE(pictures > 30);
      std::sort(errors.begin(), errors.end());
      const auto part = [&](double p) {
        return errors.empty() ? 0 : errors[static_cast<size_t>(p * double(errors.size() - 1))];
      };
      MESSAGE(std::string(drive.model) << ", " << std::string(lens) << ": " << errors.size() << " of " << pictures
                                       << " pictures tell a zenith, " << part(0.5) << " deg off in the median, "
                                       << part(0.95) << " at 95 %, " << beyond << " beyond 3 sigma");
      CHECK(part(0.5) < 1.0);
    }
  }
}
