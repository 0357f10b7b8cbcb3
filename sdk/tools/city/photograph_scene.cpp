// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/photograph_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/city/street_places.hpp"
#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Places outside buildings with the ground's height, and distances to buildings.
class Streets {
 public:
  Streets(const CityModel& city, double cell_m) : cell_m_(cell_m), low_(city.low.head<2>()) {
    StreetPlaceParameters p;
    p.spacing_m = cell_m, p.eye_m = 0;
    const Vector2d size = (city.high - city.low).head<2>() / cell_m;
    cv::Mat free(static_cast<int>(size.x()) + 2, static_cast<int>(size.y()) + 2, CV_8U, cv::Scalar(0));
    if (const auto places = places_of_grid(city, p)) places_ = *places;
    for (const Vector3d& q : places_) free.at<uint8_t>(row(q), column(q)) = 255;
    cv::distanceTransform(free, clearance_, cv::DIST_L2, 3);
  }
  const std::vector<Vector3d>& places() const { return places_; }
  double clearance_m(const Vector3d& q) const {
    const int y = row(q), x = column(q);
    if (y < 0 || x < 0 || y >= clearance_.rows || x >= clearance_.cols) return 1e3;
    return cell_m_ * static_cast<double>(clearance_.at<float>(y, x));
  }
  /// Distance to the next building in a direction; `max_m` where none is nearer.
  double free_m(const Vector3d& q, double heading, double max_m) const {
    const Vector3d along(std::cos(heading), std::sin(heading), 0);
    for (double d = 1; d < max_m; d += 1)
      if (clearance_m(q + d * along) < 0.5 * cell_m_) return d;
    return max_m;
  }
  bool is_inside(const Vector3d& q, double border_m) const {
    const int margin = static_cast<int>(border_m / cell_m_);
    return row(q) >= margin && column(q) >= margin && row(q) < clearance_.rows - margin &&
           column(q) < clearance_.cols - margin;
  }

 private:
  int row(const Vector3d& q) const { return static_cast<int>(std::lround((q.x() - low_.x()) / cell_m_)); }
  int column(const Vector3d& q) const { return static_cast<int>(std::lround((q.y() - low_.y()) / cell_m_)); }

  double cell_m_;
  Vector2d low_;
  std::vector<Vector3d> places_;
  cv::Mat clearance_;
};

namespace {

/// The same city with a random height error of each building's roofs.
CityModel with_other_roofs(CityModel city, uint64_t seed, const PhotographSceneParameters& p) {
  Random random(seed, 301);
  std::vector<double> foot(city.objects.size(), -1e9), lift;
  for (const auto& face : city.faces)
    for (const Vector3d& corner : face.corners) foot[face.object] = std::max(foot[face.object], corner.z());
  for (size_t i = 0; i < city.objects.size(); ++i) lift.push_back(p.roof_sigma_m * random.normal());
  for (auto& face : city.faces) {
    if (!city.objects[face.object].is_building) continue;
    for (Vector3d& corner : face.corners) {
      const double height = foot[face.object] - corner.z();
      if (height < p.min_height_m) continue;
      corner.z() = foot[face.object] - std::max(p.min_height_m, height + lift[face.object]);
    }
  }
  for (size_t i = 0; i < city.objects.size(); ++i) city.objects[i].top_up_m += std::max(0.0, lift[i]);
  return city;
}

Scenario scenario_of(const PhotographSceneParameters& p, const Vector3d& start) {
  Scenario scenario;
  scenario.world.type = "city";
  scenario.world.pedestrians = scenario.world.cars = 0;
  scenario.route = {{start.x(), start.y(), 0}, {start.x() + 1, start.y(), 0}};
  scenario.camera.width = p.width, scenario.camera.height = p.height;
  scenario.camera.colour = true;
  scenario.camera.row_time_s = 0, scenario.camera.exposure_s = 0, scenario.camera.pitch_rad = 0;
  return scenario;
}

/// Image processing of a phone: exposure, noise, a tone curve that lifts shadows and compresses highlights, sharpening,
/// colour, white balance.
cv::Mat developed(const cv::Mat& light, const cv::Mat& tint, Random& random) {
  const double exposure = random.uniform(0.75, 1.35), curve = random.uniform(0.3, 1.0),
               grain = random.uniform(0.5, 2.5);
  cv::Mat noise(light.size(), CV_32F), value;
  cv::RNG(random.next()).fill(noise, cv::RNG::NORMAL, 0, grain);
  value = (light * exposure + noise) / 255.0;
  cv::min(value, 1.15, value), cv::max(value, 0, value);
  cv::Mat smooth;
  cv::pow(value, 0.8, smooth);
  cv::Mat s_curve = value.mul(value).mul(3 - 2 * cv::min(value, 1.0));  // contrast
  value = (1 - curve) * smooth + curve * 0.5 * (smooth + s_curve);
  cv::Mat soft;
  cv::GaussianBlur(value, soft, {0, 0}, 1.2);
  value += random.uniform(0.2, 0.8) * (value - soft);
  const double warm = random.uniform(-0.12, 0.12), green = random.uniform(-0.04, 0.04);
  cv::Mat grey;
  value.convertTo(grey, CV_8U, 255);
  cv::Mat bgr = coloured(grey, tint);
  cv::multiply(bgr, cv::Scalar(1 - warm, 1 + green, 1 + warm), bgr);
  return bgr;
}

}  // namespace

struct PhotographScene::Parts {
  PhotographSceneParameters p;
  uint64_t seed;
  Streets streets;
  CityModel city;
  Scenario scenario;
  std::unique_ptr<World> world;
};

PhotographScene::~PhotographScene() = default;

PhotographScene::PhotographScene(const CityModel& city, uint64_t seed, const PhotographSceneParameters& p)
    : parts_(new Parts{p, seed, Streets(city, 2), with_other_roofs(city, seed, p), {}, nullptr}) {
  auto& places = parts_->streets.places();
  parts_->scenario = scenario_of(p, places.empty() ? Vector3d::Zero() : places.front());
  // Trees and cars are placed at random beside walls, all over the model.
  Random random(seed, 302);
  const double each = 4.0 / 1e4;  // area of a grid cell, ha
  for (const Vector3d& q : places) {
    const double aside = parts_->streets.clearance_m(q);
    if (random.uniform() < p.trees_per_ha * each && aside > 2.5 && aside < 9)
      parts_->scenario.world.planted.push_back({q, random.uniform(3, 9)});
    if (random.uniform() < p.cars_per_ha * each && aside > 1.5 && aside < 5)
      parts_->scenario.world.planted.push_back({q, 0});
  }
  parts_->world = std::make_unique<World>(parts_->scenario, seed, &parts_->city);
}

/// Whether the roof line is in the picture over most of its width and not formed by a nearby wall or slope.
bool PhotographScene::sees_roofs(const Vector3d& eye_n, double heading, double pitch, double angle) const {
  constexpr size_t kDirections = 180;
  const PhotographSceneParameters& p = parts_->p;
  const double top = pitch + std::atan(std::tan(0.5 * angle) * p.height / p.width) - p.below_top_rad;
  const auto line = parts_->world->skyline(eye_n, kDirections);
  int in_view = 0, seen = 0;
  for (size_t k = 0; k < kDirections; ++k) {
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(k) / kDirections;
    if (std::abs(std::remainder(azimuth - heading, 2 * std::numbers::pi)) > 0.5 * angle) continue;
    ++in_view;
    seen +=
        static_cast<double>(line[k].distance_m) > p.roofs_from_m && static_cast<double>(line[k].elevation_rad) < top;
  }
  return seen > p.roofs_part * in_view;
}

Result<SimulatedPhotograph> PhotographScene::take(uint64_t number) {
  const PhotographSceneParameters& p = parts_->p;
  const Streets& streets = parts_->streets;
  Random random(parts_->seed * 1'000'003 + number, 303);
  for (int attempt = 0; attempt < 20000 && !streets.places().empty(); ++attempt) {
    Vector3d at = streets.places()[random.next() % streets.places().size()];
    const double aside = streets.clearance_m(at), heading = random.uniform(-std::numbers::pi, std::numbers::pi);
    if (aside < p.nearest_wall_m || aside > p.farthest_wall_m || !streets.is_inside(at, 25)) continue;
    const double angle = random.uniform(p.narrowest_rad, p.widest_rad);
    if (streets.free_m(at, heading, p.view_m) < p.view_m) continue;
    int built = 0;
    for (int k = 0; k < 20; ++k)
      built += streets.free_m(at, heading + ((k + 0.5) / 20 - 0.5) * angle, p.built_m) < p.built_m;
    if (built < p.built_part * 20) continue;
    const bool in_tree =
        std::any_of(parts_->scenario.world.planted.begin(), parts_->scenario.world.planted.end(),
                    [&](const auto& tree) { return (tree.foot_n - at).template head<2>().norm() < 5; });
    if (in_tree) continue;
    at.z() -= random.uniform(1.4, 1.8);
    const double pitch = random.uniform(p.lowest_pitch_rad, p.highest_pitch_rad);
    if (!sees_roofs(at, heading, pitch, angle)) continue;
    const double roll = p.roll_sigma_rad * random.normal();
    Eigen::Matrix3d R;
    R << -std::sin(heading), 0, std::cos(heading), std::cos(heading), 0, std::sin(heading), 0, 1, 0;
    const Eigen::Quaterniond q_n_c(R * Eigen::AngleAxisd(pitch, Vector3d::UnitX()) *
                                   Eigen::AngleAxisd(roll, Vector3d::UnitZ()));
    Scenario scenario = parts_->scenario;
    scenario.camera.focal_px = 0.5 * p.width / std::tan(0.5 * angle);
    const SimCamera camera(scenario.camera, 1.0, number);
    const Motion still(1, {at}, {(q_n_c * camera.in_body().conjugate()).normalized()});
    View view(*parts_->world, camera, scenario);
    const cv::Mat light = view.render(still, 0, 0);
    return SimulatedPhotograph{developed(light, view.tint(), random), view.sky_mask(), scenario.camera.focal_px, at,
                               q_n_c};
  }
  return Failure{ODO_E_DATA, "the model has no place to take a photograph from"};
}

}  // namespace odograph
