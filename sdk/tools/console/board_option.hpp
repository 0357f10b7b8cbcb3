// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sdk/tools/calibration/calibrate_lens.hpp"

namespace odograph {

/// Options for a calibration board and a lens.
struct BoardOptions {
  std::string kind = "charuco", squares = "10x7", square = "25 mm", marker = "19 mm", family = "36h11";
  std::string model = "pinhole";
  int coefficients = 5;

  void add_board(CLI::App& command);
  void add_lens(CLI::App& command);
  Result<Board> board() const;
  LensOptions lens() const;
};

}  // namespace odograph
