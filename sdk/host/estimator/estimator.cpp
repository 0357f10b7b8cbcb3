// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/estimator/estimator.hpp"

#include <algorithm>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/estimator/inertial_estimator.hpp"
#include "sdk/host/estimator/paper_estimator.hpp"

namespace odograph {

std::unique_ptr<Estimator> make_estimator(const CouplingConfig& config, const StartPose& start,
                                          EstimatorInputs inputs) {
  if (config.type == CouplingType::inertial) return std::make_unique<InertialEstimator>(config, start, inputs);
  return std::make_unique<PaperEstimator>(config, start, inputs);
}

void resolve_geodetic(odo_fix& fix, Geodesy& geodesy) {
  if ((fix.header.flags & ODO_FIX_GEODETIC) == 0) return;
  const std::array<double, 3> geodetic{fix.latitude_rad, fix.longitude_rad, fix.height_m};
  if (!geodesy.has_origin()) geodesy.set_origin(geodetic);
  const auto p_n = geodesy.from_geodetic(geodetic);
  std::copy(p_n.begin(), p_n.end(), fix.p_n);
  fix.header.flags |= ODO_FIX_NORTH | ODO_FIX_EAST;
}

}  // namespace odograph
