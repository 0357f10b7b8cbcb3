// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/distortion.hpp"

#include <algorithm>
#include <set>

namespace odograph {

std::string take_distortion(odo_calibration& calibration, const std::string& model, std::vector<double> k) {
  static const std::set<std::string> kFisheye = {"equidistant", "fisheye", "kannala_brandt", "kannala-brandt4"};
  static const std::set<std::string> kPolynomial = {
      "", "none", "plumb_bob", "radtan", "pinhole", "brown-conrady", "rational_polynomial", "radial-tangential"};
  const bool fisheye = kFisheye.contains(model);
  if (!fisheye && !kPolynomial.contains(model))
    return "distortion model '" + model.substr(0, 40) +
           "'; expected radial-tangential or equidistant: calibrate with one of these, or give a camera.yaml";
  const size_t most = fisheye ? 4 : 8;
  while (k.size() > most && k.back() == 0) k.pop_back();
  if (k.size() > most)
    return "distortion model '" + model + "' with " + std::to_string(k.size()) + " coefficients; expected at most " +
           std::to_string(most);
  if (!k.empty()) k.resize(k.size() <= 4 ? 4 : k.size() == 5 ? 5 : 8);
  calibration.model = fisheye ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE;
  calibration.distortion_count = static_cast<uint32_t>(k.size());
  std::copy(k.begin(), k.end(), calibration.distortion);
  return {};
}

}  // namespace odograph
