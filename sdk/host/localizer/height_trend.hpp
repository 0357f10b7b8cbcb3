// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sdk/math/atmosphere.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// The newest pressure heights and their rate of climb. No allocation.
class HeightTrend {
 public:
  struct Parameters {
    double gust_s = 2;                     ///< s, correlation time of the pressure noise; judgement
    double max_silence_s = 10;             ///< s without a reading, after which the history is discarded
    int64_t min_interval_ns = 40'000'000;  ///< faster samples are skipped, so that 256 span ten seconds
  };
  struct Slope {
    double mps, sigma_mps;
    int64_t from_ns;  ///< time of the oldest height used
  };
  HeightTrend() : HeightTrend(Parameters{}) {}
  explicit HeightTrend(const Parameters& parameters) : p_(parameters) {}

  /// False if the sample followed the previous one too soon.
  bool add(int64_t t_ns, double pressure_pa) {
    if (!heights_.empty()) {
      const int64_t since = t_ns - heights_.back(0).t_ns;
      if (since < p_.min_interval_ns) return false;
      if (is_silent(t_ns)) heights_.clear();
    }
    heights_.push({t_ns, pressure_height_m(pressure_pa)});
    return true;
  }
  /// No reading for so long that the stored ones are outdated.
  bool is_silent(int64_t t_ns) const {
    return !heights_.empty() && t_ns - heights_.back(0).t_ns > nanoseconds(p_.max_silence_s);
  }
  int64_t newest_ns() const { return heights_.back(0).t_ns; }

  /// Line fit through the heights of the last `window_s`; nothing if they are fewer or span less than required.
  std::optional<Slope> slope(double window_s, double min_span_s, size_t min_samples) const {
    if (heights_.empty()) return std::nullopt;
    double n = 0, t_sum = 0, h_sum = 0, tt = 0, th = 0, hh = 0, span_s = 0;
    const Height newest = heights_.back(0);
    int64_t from_ns = newest.t_ns;
    for (size_t k = 0; k < heights_.size(); ++k) {
      const double t = seconds(heights_.back(k).t_ns - newest.t_ns), h = heights_.back(k).m - newest.m;
      if (t < -window_s) break;
      n += 1, t_sum += t, h_sum += h, tt += t * t, th += t * h, hh += h * h;
      span_s = -t, from_ns = heights_.back(k).t_ns;
    }
    if (n < static_cast<double>(min_samples) || span_s < min_span_s) return std::nullopt;
    tt -= t_sum * t_sum / n, th -= t_sum * h_sum / n, hh -= h_sum * h_sum / n;
    const double slope = th / tt, scatter = std::sqrt(std::max(0.0, hh - slope * th) / (n - 2));
    return Slope{slope, scatter * std::sqrt(12 / std::min(n, span_s / p_.gust_s)) / span_s, from_ns};
  }

 private:
  struct Height {
    int64_t t_ns;
    double m;
  };
  Parameters p_;
  Ring<Height, 256> heights_;
};

}  // namespace odograph
