// SPDX-License-Identifier: Apache-2.0
//
// Digest of a run's results: for each column of numbers the count, mean, root mean square, quartiles and five values.
// It is small enough to be stored with the tests, and sensitive to most changes of any number by more than a millionth
// of the column's size; hence no column may contain an offset or values of another size.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

class Digest {
 public:
  void add(const std::string& column, double value) {
    if (std::isnan(value))
      columns_[column + ".nan"].push_back(1);
    else
      columns_[column].push_back(value);
  }
  void add(const std::string& column, const double* values, size_t count, size_t stride = 1) {
    for (size_t i = 0; i < count; ++i) add(column + '.' + std::to_string(i), values[i * stride]);
  }

  /// Two weighted sums of each 3x3 block of a square matrix, which are sensitive to a change of any number.
  void add_blocks(const std::string& column, const double* values, size_t size) {
    for (size_t row = 0; row < size; row += 3)
      for (size_t from = 0; from < size; from += 3) {
        double sums[2] = {0, 0};
        for (size_t i = 0; i < 9; ++i) {
          const double value = values[(row + i / 3) * size + from + i % 3], k = static_cast<double>(i);
          sums[0] += std::cos(k) * value, sums[1] += (1 + 0.1 * k) * value;
        }
        add(column + '.' + std::to_string(row / 3) + std::to_string(from / 3), sums, 2);
      }
  }

  /// One line per column: name, count, quartiles, mean, root mean square, five values from first to last.
  std::string text() const {
    std::ostringstream out;
    out.precision(10);
    for (const auto& [name, values] : columns_) {
      out << name << ' ' << values.size();
      std::vector<double> sorted = values;
      std::sort(sorted.begin(), sorted.end());
      for (size_t i = 1; i <= 3; ++i) out << ' ' << sorted[(sorted.size() - 1) * i / 4];
      out << ' ' << mean(values, 1) << ' ' << std::sqrt(mean(values, 2));
      for (size_t i = 0; i <= 4; ++i) out << ' ' << values[(values.size() - 1) * i / 4];
      out << '\n';
    }
    return out.str();
  }

 private:
  static double mean(const std::vector<double>& values, int power) {
    double sum = 0;
    for (double v : values) sum += power == 1 ? v : v * v;
    return sum / static_cast<double>(values.size());
  }
  std::map<std::string, std::vector<double>> columns_;  // none empty, none with NaN
};

/// Comparison of two digests.
struct Tolerance {
  double part;          ///< of a column's root mean square, and of its count
  bool quartiles_only;  ///< for results whose single numbers depend on the last digits of their input
};

/// Below this count quartiles and small differences of the count are not compared.
inline constexpr double kFew = 30;

/// The columns that differ, each with both lines.
inline std::vector<std::string> differences(const std::string& kept, const std::string& now, Tolerance tolerance) {
  using Columns = std::map<std::string, std::vector<double>>;
  const auto columns_of = [](const std::string& text) {
    Columns columns;
    std::istringstream lines(text);
    for (std::string line, name, word; std::getline(lines, line);) {
      std::istringstream words(line);
      words >> name;
      while (words >> word) columns[name].push_back(std::stod(word));
    }
    return columns;
  };
  const auto shown = [](const Columns& columns, const std::string& name) {
    std::ostringstream out;
    out.precision(10);
    if (!columns.count(name)) return std::string(" nothing");
    for (double v : columns.at(name)) out << ' ' << v;
    return out.str();
  };
  const Columns before = columns_of(kept), after = columns_of(now);
  Columns all = before;
  all.insert(after.begin(), after.end());
  std::vector<std::string> differing;
  for (const auto& [name, unused] : all) {
    bool same = before.count(name) && after.count(name);
    if (same) {
      const auto &a = before.at(name), &b = after.at(name);
      const double rms = std::max(a[5], 1e-9);  // rounding errors of zero are smaller
      same = std::abs(a[0] - b[0]) <= std::max(tolerance.quartiles_only ? 3.0 : 0.0, tolerance.part * a[0]);
      const size_t compared = !tolerance.quartiles_only ? a.size() : a[0] < kFew ? 1 : 4;
      for (size_t i = 1; i < compared; ++i) same = same && std::abs(a[i] - b[i]) <= tolerance.part * rms;
    }
    if (!same) differing.push_back(name + "\n  kept" + shown(before, name) + "\n  now " + shown(after, name));
  }
  return differing;
}
