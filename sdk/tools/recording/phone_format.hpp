// SPDX-License-Identifier: Apache-2.0
//
// Recording apps' tables: files, columns, units, axes and clocks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odograph::phone {

/// Content of a table's rows.
enum class Stream {
  gyro,          ///< x y z, rad/s
  accel,         ///< x y z, specific force, m/s^2
  linear_accel,  ///< x y z, the same without gravity; needs `gravity`
  gravity,       ///< x y z, the difference
  field,         ///< x y z, T
  pressure,      ///< Pa
  place,  ///< latitude, longitude (degrees), height (m), sigma of position, of height (m); optional from height on
  frame,  ///< all optional: fx, fy, cx, cy (px), exposure (ns), readout of the whole picture (ns)
  pose,   ///< x y z (m), qx qy qz qw of the camera, in a world whose y axis points up
};

enum class TimeUnit { nanoseconds, milliseconds, seconds };

/// Platforms on which a table exists.
enum class When { any, android, apple };  ///< apple: iOS's own signs and units

/// File layouts.
enum class Layout {
  csv,         ///< a head with names, or none: then the columns are "#1", "#2", ...
  named_rows,  ///< GnssLogger: each row starts with its kind; a comment "# Kind,column,..." names the columns
  json_lines,  ///< an object per line: columns are JSON pointers
  protobuf,    ///< columns are field numbers: "4.2" is the second value of field 4
};

/// Scale determined by the magnitude of gravity: g or m/s^2.
constexpr double kByGravity = 0;

struct Table {
  Stream stream;
  const char* file;  ///< '*': any characters; "A|B": the first that exists
  const char* time;  ///< column; "": rows have no time of their own
  TimeUnit unit = TimeUnit::nanoseconds;
  std::vector<const char*> columns{};  ///< "a|b": either; a leading '?': optional
  double scale = 1;                    ///< to SI, including the sign
  When when = When::any;
  uint32_t flags = 0;     ///< of the message
  const char* kind = "";  ///< named_rows: the row's kind; json_lines: "/pointer=value" that a row must have; protobuf:
                          ///< the field of the rows
  const char* unix_time = "";  ///< the same time as Unix time, if the app writes it; equal to `time`: there is no other
  TimeUnit unix_unit = TimeUnit::nanoseconds;
  bool has_unix_time_alone() const { return *unix_time && time == unix_time; }
};

/// Source of the frame times.
enum class FrameTimes {
  table,           ///< Stream::frame, one row per frame
  metadata_track,  ///< in the video itself, as Unix time; otherwise the file name and an assumption
};

struct Format {
  const char* name;
  std::vector<const char*> marks;  ///< files of which one must exist
  Layout layout;
  std::vector<Table> tables;  ///< for each stream, the first whose file exists
  const char* video = "";     ///< as Table::file
  const char* pictures = "";  ///< instead of a video: their names are Unix times in ms
  FrameTimes frame_times = FrameTimes::table;
  const char* head = "";  ///< what the first line of the mark contains, where apps use the same file names
  /// Which option to enable, by stream, in the app's own words; "": none.
  const char *switch_on_gyro, *switch_on_accel, *switch_on_video, *switch_on_others;
};

/// All formats, in search order.
const std::vector<Format>& formats();

/// Name for messages. Poses are the platform's own and serve only as reference.
const char* name_of(Stream stream);

/// Whether `name` matches `pattern` ('*': any characters; "A|B": either).
bool matches(const std::string& pattern, const std::string& name);

}  // namespace odograph::phone
