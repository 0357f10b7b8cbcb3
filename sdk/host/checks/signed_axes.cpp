// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/signed_axes.hpp"

#include <algorithm>

namespace odograph {
namespace {

std::array<SignedAxes, 48> make_all() {
  std::array<SignedAxes, 48> all;
  std::array<int8_t, 3> from{0, 1, 2};
  size_t n = 0;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      const auto sign = [signs](int axis) { return static_cast<int8_t>((signs >> axis) & 1 ? -1 : 1); };
      all[n++] = {from, {sign(0), sign(1), sign(2)}};
    }
  } while (std::next_permutation(from.begin(), from.end()));
  std::stable_sort(all.begin(), all.end(),
                   [](const SignedAxes& a, const SignedAxes& b) { return a.changes() < b.changes(); });
  return all;
}

}  // namespace

SignedAxes SignedAxes::of_opposite_rate() const {
  const int parity = from[1] == (from[0] + 1) % 3 ? 1 : -1, determinant = parity * sign[0] * sign[1] * sign[2];
  SignedAxes out;
  for (size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<size_t>(from[i]);
    out.from[k] = static_cast<int8_t>(i), out.sign[k] = static_cast<int8_t>(-determinant * sign[i]);
  }
  return out;
}

std::string SignedAxes::text() const {
  std::string out;
  for (size_t i = 0; i < 3; ++i) {
    out += i == 0 ? "(" : ", ";
    if (sign[i] < 0) out += '-';
    out += "xyz"[from[i]];
  }
  return out + ")";
}

const std::array<SignedAxes, 48>& all_signed_axes() {
  static const std::array<SignedAxes, 48> all = make_all();
  return all;
}

}  // namespace odograph
