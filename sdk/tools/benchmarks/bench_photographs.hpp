// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_case.hpp"
#include "sdk/tools/city/model_errors.hpp"

namespace odograph {

/// Single photographs, rendered by seeds in city models with height errors: fraction that is placed, errors, and rate
/// of overconfident results.
struct PhotographBench {
  void add_options(CLI::App& command);
  /// `count` photographs in each model, ten under one sun and with one seed.
  Result<std::vector<BenchCase>> cases(const std::vector<std::string>& models, const BenchOptions& options) const;
  Result<Json> measure(const BenchCase& one, const BenchOptions& options) const;
  BenchReport report(const Rows& rows) const;

  size_t count = 0;  ///< 0: no photographs, drives instead
  ModelErrors errors{.missing = 0.1, .roof_sigma_m = 1.5};
  double sigma_m = 10, heading_sigma_deg = 20, prior_off_m = 0;
  bool each = false;
};

}  // namespace odograph
