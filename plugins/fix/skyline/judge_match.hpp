// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {

/// Why a frame gave no fix, as reports and summaries name it.
enum Reason : size_t { kPrior, kSky, kAgreement, kAmbiguity, kReasons };
inline constexpr const char* kReasonNames[kReasons] = {"prior", "sky", "agreement", "ambiguity"};
using Why = std::pair<Reason, std::string>;

/// What a refusal of the matcher is called.
Why reason_of(Refusal refusal);

/// Of a match of one picture. By hand, on drives through a model of Delft, where no source is named.
struct MatchJudgeParameters {
  double fewer_agree =
      0.8;  ///< of min_agreement: of a place found by several pictures, or without another likely place,
  double no_rival = 1e-20;             ///< none being likelier than this (42 such in Delft: one was 1.1 m off)
  double max_second_best_ratio = 0.2;  ///< of another place's likelihood
};

/// What speaks against a match of one picture. `several_agree`: pictures before have told the place.
std::optional<Why> judge_match(const Match& match, double min_agreement, bool several_agree,
                               const MatchJudgeParameters& p = {});

/// Judges matches of several narrow pictures along a path. Such pictures see walls rather than roofs: in fewer
/// directions do picture and model agree, and one match may be right by chance; so no other place may be likely at all,
/// and where few directions agree two matches in a row must tell the same offset of the odometry.
class PathJudge {
 public:
  struct Parameters {
    double max_second_best_ratio = 1e-6;  ///< likelihood of another place over that of the best
    double min_agreement = 0.35;  ///< of the directions with a roof's edge: right matches in Delft's streets had .4
    double same_m = 2;            ///< two matches in a row that differ by less
    double same_rad = 0.052;      ///< and by less than three degrees say the same
  };

  PathJudge() : PathJudge(Parameters{}) {}
  explicit PathJudge(const Parameters& parameters) : p_(parameters) {}

  /// What speaks against a match. `p_n`, `q_n_c`: what was thought of its place.
  std::optional<Why> judge(const Match& match, const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c,
                           double min_agreement);
  /// A correction of n: what was at x is at q x + p. The city stays where it is.
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  void clear() { before_.reset(); }

 private:
  struct Offset {
    Eigen::Quaterniond q;  // what was thought at x was matched at q x + p
    Eigen::Vector3d p;
  };
  Parameters p_;
  std::optional<Offset> before_;  // by the match before
};

}  // namespace odograph::skyline
