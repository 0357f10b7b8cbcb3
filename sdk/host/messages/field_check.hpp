// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <odograph/base.h>

#include "sdk/host/messages/bounds.hpp"
#include "sdk/math/number_text.hpp"

namespace odograph {

/// Records the first fault found.
class FieldCheck {
 public:
  explicit FieldCheck(const odo_header& header) : flags_(header.flags) {
    when(ODO_FLAG_QUALITY).fraction("quality", header.quality).always();
  }

  /// The following checks apply only if this validity bit is set.
  FieldCheck& when(uint32_t bit) {
    active_ = (flags_ & bit) != 0;
    return *this;
  }
  FieldCheck& always() {
    active_ = true;
    return *this;
  }
  FieldCheck& require(bool holds, const char* field, double value, const char* expected) {
    if (active_ && !holds && fault.empty())
      fault = std::string(field) + " = " + number_text(value) + "; expected " + expected;
    return *this;
  }
  FieldCheck& within(const char* field, double value, const bounds::Bounds& bounds) {
    require(std::isfinite(value), field, value, "a finite number");
    return require(bounds.holds(value), field, value, bounds.text);
  }
  FieldCheck& within(const char* field, const double* values, size_t count, const bounds::Bounds& bounds) {
    for (size_t i = 0; active_ && i < count && fault.empty(); ++i)
      if (!bounds.holds(values[i]))
        within(count == 1 ? field : (std::string(field) + "[" + std::to_string(i) + "]").c_str(), values[i], bounds);
    return *this;
  }
  /// A sensor's values; SampleGate checks their range.
  FieldCheck& sensed(const char* field, const double* values, size_t count) {
    constexpr bounds::Bounds kFinite = {-1.7e308, 1.7e308, "a finite number"};
    return within(field, values, count, kFinite);
  }
  FieldCheck& finite(const char* field, double value) { return within(field, value, bounds::kAnything); }
  FieldCheck& finite(const char* field, const double* values, size_t count) {
    return within(field, values, count, bounds::kAnything);
  }
  /// A row-major covariance matrix.
  FieldCheck& covariance(const char* field, const double* values, size_t rows) {
    constexpr bounds::Bounds kFinite = {-bounds::kMaxVariance, bounds::kMaxVariance, "within +-1e15"};
    within(field, values, rows * rows, kFinite);
    for (size_t i = 0; active_ && i < rows && fault.empty(); ++i)
      if (const size_t at = i * (rows + 1); values[at] < 0)
        not_negative((std::string(field) + "[" + std::to_string(at) + "]").c_str(), values[at]);
    if (active_ && fault.empty() && !bounds::is_covariance(values, rows))
      fault = std::string(field) + " is not a covariance; expected a symmetric positive semidefinite matrix";
    return *this;
  }
  /// Variance of a component that is stated as known.
  FieldCheck& known(const char* field, double variance) {
    return require(variance >= bounds::kMinKnownVariance, field, variance,
                   "a variance of at least 1e-12 for a known component");
  }
  FieldCheck& unit(const char* field, const double* q) {
    finite(field, q, 4);
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (active_ && fault.empty() && !(std::abs(norm - 1.0) < 1e-3))
      fault = std::string(field) + " has the norm " + number_text(norm) + "; expected a quaternion of norm 1";
    return *this;
  }
  FieldCheck& unit3(const char* field, const double* v) {
    finite(field, v, 3);
    const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return require(std::abs(norm - 1.0) < 1e-3, field, norm, "a vector of norm 1");
  }
  FieldCheck& fraction(const char* field, double value) {
    return finite(field, value).require(value >= 0 && value <= 1, field, value, "0 to 1");
  }
  FieldCheck& positive(const char* field, double value) {
    return finite(field, value).require(value > 0, field, value, "above 0");
  }
  FieldCheck& not_negative(const char* field, double value) {
    return finite(field, value).require(value >= 0, field, value, "0 or more");
  }

  std::string fault;

 private:
  uint32_t flags_;
  bool active_ = true;
};

}  // namespace odograph
