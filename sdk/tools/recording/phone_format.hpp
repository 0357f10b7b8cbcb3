// SPDX-License-Identifier: Apache-2.0
//
// What a phone's recording app writes, as tables: which files, which columns, in which units, axes and clock.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odograph::phone {

/// What a table's rows are.
enum class Stream {
  gyro,          ///< x y z, rad/s
  accel,         ///< x y z, specific force, m/s^2
  linear_accel,  ///< x y z, the same without gravity; needs `gravity`
  gravity,       ///< x y z, what it lacks
  field,         ///< x y z, T
  pressure,      ///< Pa
  place,  ///< latitude, longitude (degrees), height (m), sigma of position, of height (m), each optional from height on
  frame,  ///< each optional: fx, fy, cx, cy (px), exposure (ns), readout of the whole picture (ns)
  pose,   ///< x y z (m), qx qy qz qw: of the camera, in a world whose y axis points up
};

enum class TimeUnit { nanoseconds, milliseconds, seconds };

/// When a table is one that the recording can have.
enum class When { any, android, apple };  ///< apple: iOS's own signs and units

/// Where rows come from.
enum class Layout {
  csv,         ///< a head with names, or none: then columns are "#1", "#2", ...
  named_rows,  ///< GnssLogger: each row starts with its kind, a comment "# Kind,column,..." names the columns
  json_lines,  ///< an object a line: columns are JSON pointers
  protobuf,    ///< columns are field numbers: "4.2" is the second value of field 4
};

/// Where a scale is not one number: g or m/s^2, by the size of gravity.
constexpr double kByGravity = 0;

struct Table {
  Stream stream;
  const char* file;  ///< '*' stands for any characters; "A|B": the first that is there
  const char* time;  ///< its column; "" : rows have none of their own
  TimeUnit unit = TimeUnit::nanoseconds;
  std::vector<const char*> columns{};  ///< "a|b": either; a leading '?': optional
  double scale = 1;                    ///< to SI, sign included
  When when = When::any;
  uint32_t flags = 0;          ///< of the message
  const char* kind = "";       ///< named_rows: the row's kind; json_lines: "/pointer=value" that a row must have;
                               ///< protobuf: the field of the rows
  const char* unix_time = "";  ///< the same moment as Unix time, where the app writes it
  TimeUnit unix_unit = TimeUnit::nanoseconds;
};

/// How its frames' times are found.
enum class FrameTimes {
  table,           ///< Stream::frame, one row a frame
  metadata_track,  ///< in the video itself, as Unix time; failing that the file's name and a guess
};

struct Format {
  const char* name;
  std::vector<const char*> marks;  ///< files of which one must be there
  Layout layout;
  std::vector<Table> tables;  ///< of each stream the first whose file is there
  const char* video = "";     ///< as Table::file
  const char* pictures = "";  ///< instead of a video: their names are Unix times in ms
  FrameTimes frame_times = FrameTimes::table;
  /// What to switch on, by stream, in the app's own words; "" : there is nothing.
  const char *switch_on_gyro, *switch_on_accel, *switch_on_video, *switch_on_others;
};

/// All of them, in the order in which they are looked for.
const std::vector<Format>& formats();

/// The format's table is a reference, no input, where poses are the platform's own.
const char* name_of(Stream stream);

/// Whether `name` is as `pattern` has it ('*': any characters; "A|B": either).
bool matches(const std::string& pattern, const std::string& name);

}  // namespace odograph::phone
