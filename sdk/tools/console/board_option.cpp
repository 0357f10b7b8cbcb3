// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/console/board_option.hpp"

#include "sdk/host/config/spec.hpp"

namespace odograph {

void BoardOptions::add_board(CLI::App& command) {
  command.add_option("--board", kind, "charuco or checkerboard")
      ->capture_default_str()
      ->check(CLI::IsMember({"charuco", "checkerboard"}));
  command.add_option("--squares", squares, "COLUMNSxROWS, counting squares, not inner corners")->capture_default_str();
  command.add_option("--square", square, "side of a square with its unit, measured on the print")
      ->capture_default_str();
  command.add_option("--marker", marker, "side of a marker's black border with its unit (charuco)")
      ->capture_default_str();
  command
      .add_option("--family", family,
                  "family of the markers (charuco): 36h11, 25h9 or 16h5; OpenCV: DICT_APRILTAG_36h11 and so on")
      ->capture_default_str();
}

void BoardOptions::add_lens(CLI::App& command) {
  command.add_option("--model", model, "pinhole (radial-tangential) or kannala_brandt (wide angle, fisheye)")
      ->capture_default_str()
      ->check(CLI::IsMember({"pinhole", "kannala_brandt"}));
  command.add_option("--coefficients", coefficients, "coefficients of the pinhole's distortion: 0, 4, 5 or 8")
      ->capture_default_str()
      ->check(CLI::IsMember({0, 4, 5, 8}));
}

Result<Board> BoardOptions::board() const {
  Board board;
  board.kind = kind == "charuco" ? Board::Kind::charuco : Board::Kind::checkerboard;
  board.family = family;
  char end = 0;
  if (std::sscanf(squares.c_str(), "%dx%d%c", &board.columns, &board.rows, &end) != 2)
    return Failure{ODO_E_ARGUMENT, "--squares: '" + squares + "'; expected COLUMNSxROWS, as in 10x7"};
  for (const auto& [name, text, value] :
       {std::tuple{"--square", &square, &board.square_m}, {"--marker", &marker, &board.marker_m}}) {
    const auto length = parse_quantity(*text, "m");
    if (!length)
      return Failure{ODO_E_ARGUMENT, std::string(name) + ": '" + *text + "'; expected a length, as in '25 mm'"};
    *value = *length;
  }
  if (const auto wrong = invalid_reason(board)) return Failure{ODO_E_ARGUMENT, "board: " + *wrong};
  return board;
}

LensOptions BoardOptions::lens() const {
  return {.lens = model == "pinhole" ? Lens::pinhole : Lens::kannala_brandt, .coefficients = coefficients};
}

}  // namespace odograph
