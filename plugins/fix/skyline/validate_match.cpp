// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/validate_match.hpp"

#include <cstdio>

namespace odograph::skyline {
namespace {

Rejection few_agree(double agreement, double least) {
  char text[120];
  std::snprintf(text, sizeof text, "%.2f of the directions agree, %.2f are required", agreement, least);
  return {kAgreement, text};
}

Rejection another(double second_best_ratio) {
  char text[120];
  std::snprintf(text, sizeof text, "another place is %.2g times as likely", second_best_ratio);
  return {kAmbiguity, text};
}

}  // namespace

Rejection rejection_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::few_edges: return {kSky, "too few directions with a roof's edge"};
    case Refusal::nothing_in_view: return {kAgreement, "the model has no roof in view"};
    case Refusal::beyond: return {kAgreement, "the best place lies outside the searched area"};
    case Refusal::gathering: return {kAmbiguity, "lost: more pictures must agree"};
    default: return {kAmbiguity, "pictures disagree about the place"};
  }
}

std::optional<Rejection> validate_match(const Match& match, double min_agreement, bool several_agree,
                                        const MatchValidationParameters& p) {
  const bool sure = several_agree || match.second_best_ratio < p.unrivalled_ratio;
  const double least = sure ? p.min_agreement_factor * min_agreement : min_agreement;
  if (match.agreement < least) return few_agree(match.agreement, least);
  if (match.second_best_ratio > p.max_second_best_ratio) return another(match.second_best_ratio);
  return std::nullopt;
}

std::optional<Rejection> PathMatchValidator::validate(const Match& match, const Eigen::Vector3d& p_n,
                                                      const Eigen::Quaterniond& q_n_c, double min_agreement) {
  const Eigen::Quaterniond q = (match.q_n_c * q_n_c.conjugate()).normalized();
  const auto before = std::exchange(before_, std::nullopt);
  if (match.agreement < p_.min_agreement) return few_agree(match.agreement, p_.min_agreement);
  if (match.second_best_ratio > p_.max_second_best_ratio) return another(match.second_best_ratio);
  before_ = Offset{q, match.p_n - q * p_n};
  if (match.agreement >= min_agreement) return std::nullopt;
  if (!before) return Rejection{kAmbiguity, "few directions agree: the next match must give the same place"};
  const double apart_m = (match.p_n - (before->q * p_n + before->p)).head<2>().norm();
  if (apart_m < p_.same_m && q.angularDistance(before->q) < p_.same_rad) return std::nullopt;
  return Rejection{kAmbiguity, "few directions agree, and the previous match gave another place"};
}

void PathMatchValidator::correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  if (!before_) return;
  before_->q = (before_->q * q.conjugate()).normalized();
  before_->p -= before_->q * p;
}

}  // namespace odograph::skyline
