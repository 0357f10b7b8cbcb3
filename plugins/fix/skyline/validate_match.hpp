// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {

/// Reason for no fix, as named in reports and summaries.
enum Reason : size_t { kPrior, kSky, kAgreement, kAmbiguity, kReasons };
inline constexpr const char* kReasonNames[kReasons] = {"prior", "sky", "agreement", "ambiguity"};
using Rejection = std::pair<Reason, std::string>;

/// The reason that corresponds to a refusal of the matcher.
Rejection rejection_of(Refusal refusal);

/// For a match of one picture. Unless a source is named, chosen empirically on drives through a model of Delft.
struct MatchValidationParameters {
  double min_agreement_factor =
      0.8;  ///< factor on min_agreement for a place by several pictures or without an alternative:
  double unrivalled_ratio = 1e-20;     ///< a likelihood ratio below this (42 such in Delft: one was 1.1 m off)
  double max_second_best_ratio = 0.2;  ///< of another place's likelihood
};

/// The reason to reject a match of one picture, if any. `several_agree`: earlier pictures gave the same place.
std::optional<Rejection> validate_match(const Match& match, double min_agreement, bool several_agree,
                                        const MatchValidationParameters& p = {});

/// Accepts or rejects matches of several narrow pictures along a path. Such pictures see walls rather than roofs:
/// picture and model agree in fewer directions, and a single match may fit by chance. Therefore no other place may be
/// likely, and where few directions agree two consecutive matches must give the same offset of the odometry.
class PathMatchValidator {
 public:
  struct Parameters {
    double max_second_best_ratio = 1e-6;  ///< max likelihood of another place over that of the best
    double min_agreement = 0.35;  ///< of the directions with a roof's edge: correct matches in Delft's streets had .4
    double same_m = 2;            ///< max difference of consecutive matches that agree
    double same_rad = 0.052;      ///< the same in heading: three degrees
  };

  PathMatchValidator() : PathMatchValidator(Parameters{}) {}
  explicit PathMatchValidator(const Parameters& parameters) : p_(parameters) {}

  /// The reason to reject a match, if any. `p_n`, `q_n_c`: the prior pose.
  std::optional<Rejection> validate(const Match& match, const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c,
                                    double min_agreement);
  /// A correction of n moves x to q x + p. The city does not move.
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  void clear() { before_.reset(); }

 private:
  struct Offset {
    Eigen::Quaterniond q;  // the prior position x was matched at q x + p
    Eigen::Vector3d p;
  };
  Parameters p_;
  std::optional<Offset> before_;  // of the previous match
};

}  // namespace odograph::skyline
