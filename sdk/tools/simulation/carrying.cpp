// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/carrying.hpp"

#include <cmath>

#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kGravity_mps2 = 9.80665;

}  // namespace

CarriedPose on_leg(double phase, double vigour, double height_m) {
  constexpr double kFlexion_rad = 0.35, kSwing_rad = 0.40, kFaster = 0.3, kPelvis_m = 0.01;
  const double lever_m = 0.14 * height_m;  // of the thigh
  const double stride = std::cos(kPi * phase) + kFaster * std::sin(2 * kPi * phase);
  const double angle = vigour * (kFlexion_rad + kSwing_rad * stride);
  // The pelvis rises and falls with its leg.
  const double own_side = vigour * kPelvis_m * std::cos(kPi * phase - 0.8);
  const Vector3d hip(0.08, 0.14, -0.52 * height_m - own_side);
  return {hip + lever_m * Vector3d(std::sin(angle), 0, std::cos(angle)), angle, 0.15};
}

Bag::Bag(const std::vector<Vector3d>& trunk_n, const Signal& heading_rad, double length_m, double damping,
         double rate_hz)
    : strap_m(length_m), forward_rad(trunk_n.size()), right_rad(trunk_n.size()) {
  const double dt = 1 / rate_hz, w2 = kGravity_mps2 / strap_m, friction = 2 * damping * std::sqrt(w2);
  Eigen::Vector2d angle = Eigen::Vector2d::Zero(), rate = angle;  // north, east
  for (size_t i = 1; i + 1 < trunk_n.size(); ++i) {
    const Eigen::Vector2d pull = (trunk_n[i + 1] - 2 * trunk_n[i] + trunk_n[i - 1]).head<2>() * rate_hz * rate_hz;
    rate += dt * (-w2 * angle - friction * rate - pull / strap_m);
    angle += dt * rate;
    const double c = std::cos(heading_rad[i]), s = std::sin(heading_rad[i]);
    forward_rad[i] = c * angle.x() + s * angle.y(), right_rad[i] = c * angle.y() - s * angle.x();
  }
}

CarriedPose Bag::at(size_t sample, double height_m) const {
  const double forward = forward_rad[sample], right = right_rad[sample];
  const Vector3d shoulder(-0.02, -0.22, -0.80 * height_m);
  return {shoulder + strap_m * Vector3d(std::sin(forward), std::sin(right), std::cos(forward) * std::cos(right)),
          forward, 1.2 - right};  // the phone lies on its side
}

bool is_carry(const std::string& what) { return what == "texting" || what == "swinging" || is_covered(what); }

bool is_covered(const std::string& carry) { return carry == "pocket" || carry == "leg" || carry == "bag"; }

}  // namespace odograph
