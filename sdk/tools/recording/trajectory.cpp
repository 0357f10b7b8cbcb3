// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/trajectory.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iomanip>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/number_text.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/text_rows.hpp"

namespace odograph {

Result<int64_t> parse_seconds(std::string_view text) {
  constexpr int64_t kFarthest_s = kFarthestTime_ns / 1'000'000'000 - 1;
  const Failure wrong{ODO_E_DATA, "'" + std::string(text.substr(0, 40)) + "' is not a time in seconds"};
  if (text.find_first_of("eE") != std::string_view::npos) {  // KITTI writes 1.0e-01
    const auto seconds = parse_number(text);
    if (!seconds || !(std::abs(*seconds) <= kFarthest_s)) return wrong;
    return nanoseconds(*seconds);
  }
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) text.remove_prefix(1);
  const size_t point = std::min(text.find('.'), text.size());
  int64_t whole = 0, fraction = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + point, whole);
  if (parsed.ptr != text.data() + point || parsed.ec != std::errc() || whole < 0 || whole > kFarthest_s) return wrong;
  int64_t unit = 100'000'000;
  for (size_t i = point + 1; i < text.size(); ++i, unit /= 10) {
    if (text[i] < '0' || text[i] > '9') return wrong;
    fraction += unit * (text[i] - '0');
  }
  const int64_t t_ns = whole * 1'000'000'000 + fraction;
  return negative ? -t_ns : t_ns;
}

std::string format_seconds(int64_t t_ns) {
  const bool negative = t_ns < 0;
  const uint64_t magnitude = negative ? 0 - static_cast<uint64_t>(t_ns) : static_cast<uint64_t>(t_ns);
  std::string fraction = std::to_string(magnitude % 1'000'000'000);
  fraction.insert(0, 9 - fraction.size(), '0');
  return (negative ? "-" : "") + std::to_string(magnitude / 1'000'000'000) + "." + fraction;
}

namespace {

Result<bool> add_pose(StampedPoses& trajectory, const TextRow& row, int64_t t_ns, const Eigen::Quaterniond& q,
                      const Eigen::Vector3d& p) {
  const double norm = q.norm();
  if (!(norm > 0.5 && norm < 2.0)) return row.wrong("the quaternion has norm " + std::to_string(norm) + ", expected 1");
  trajectory.push_back({t_ns, q.normalized(), p});
  return true;
}

/// The poses that `take` adds for each row, at least one.
template <class Take>
Result<StampedPoses> poses_in(const std::filesystem::path& path, const Take& take) {
  StampedPoses trajectory;
  const auto done = read_rows(path, [&](const TextRow& row) -> Result<bool> { return take(row, trajectory); });
  if (!done) return done.failure();
  if (trajectory.empty()) return Failure{ODO_E_DATA, path.string() + ": no poses in it"};
  return trajectory;
}

/// Whether a comment at the head names the columns of the quaternion with w first.
bool w_is_first(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // nobody may write to a pipe
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line.starts_with('#'))
    if (const size_t w = line.find("qw"), x = line.find("qx"); w != std::string::npos && x != std::string::npos)
      return w < x;
  return false;
}

/// Seconds; or nanoseconds, which ORB-SLAM3 writes, with a fraction of 0: as seconds they are 30,000 years and more.
Result<int64_t> parse_time(std::string_view text) {
  constexpr size_t kDigitsOf30000Years_s = 12;
  const size_t point = std::min(text.find('.'), text.size());
  if (point <= kDigitsOf30000Years_s || text.find_first_of("eE-") != std::string_view::npos) return parse_seconds(text);
  int64_t t_ns = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + point, t_ns);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + point ? Result<int64_t>(t_ns) : parse_seconds(text);
}

}  // namespace

Result<StampedPoses> read_tum(const std::filesystem::path& path) {
  const size_t w = w_is_first(path) ? 4 : 7, x = w == 4 ? 5 : 4;
  return poses_in(path, [&](const TextRow& row, StampedPoses& trajectory) -> Result<bool> {
    const auto v = numbers(row, 8);
    if (!v) return v.failure();
    const auto t = parse_time(row.fields[0]);
    if (!t) return row.wrong(t.failure().text);
    return add_pose(trajectory, row, *t, {(*v)[w], (*v)[x], (*v)[x + 1], (*v)[x + 2]}, {(*v)[1], (*v)[2], (*v)[3]});
  });
}

Result<StampedPoses> read_kitti_poses(const std::filesystem::path& path, const std::filesystem::path& times) {
  const auto stamps = times.empty() ? Result(std::vector<int64_t>()) : read_times(times);
  if (!stamps) return stamps.failure();
  return poses_in(path, [&](const TextRow& row, StampedPoses& trajectory) -> Result<bool> {
    const auto v = numbers(row, 12);
    if (!v) return v.failure();
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) R(i, j) = (*v)[static_cast<size_t>(4 * i + j)];
      p[i] = (*v)[static_cast<size_t>(4 * i + 3)];
    }
    if (std::abs(R.determinant() - 1.0) > 0.01) return row.wrong("the first three columns are no rotation");
    const size_t k = trajectory.size();
    return add_pose(trajectory, row, k < stamps->size() ? (*stamps)[k] : static_cast<int64_t>(k) * kKittiInterval_ns,
                    Eigen::Quaterniond(R), p);
  });
}

Result<StampedPoses> read_euroc_truth(const std::filesystem::path& path) {
  return poses_in(path, [&](const TextRow& row, StampedPoses& trajectory) -> Result<bool> {
    const auto v = numbers(row, 8);
    const bool in_seconds = row.fields[0].find('.') != std::string_view::npos;
    const auto t = in_seconds ? parse_seconds(row.fields[0]) : row.time_ns(0);
    if (!v) return v.failure();
    if (!t) return t.failure();
    return add_pose(trajectory, row, *t, {(*v)[4], (*v)[5], (*v)[6], (*v)[7]}, {(*v)[1], (*v)[2], (*v)[3]});
  });
}

double path_length(const StampedPoses& trajectory) {
  double length = 0;
  for (size_t i = 1; i < trajectory.size(); ++i) length += (trajectory[i].p - trajectory[i - 1].p).norm();
  return length;
}

void write_tum(std::ostream& out, const StampedPoses& trajectory) {
  out << std::setprecision(12);
  for (const auto& x : trajectory)
    out << format_seconds(x.t_ns) << ' ' << x.p.x() << ' ' << x.p.y() << ' ' << x.p.z() << ' ' << x.q.x() << ' '
        << x.q.y() << ' ' << x.q.z() << ' ' << x.q.w() << '\n';
}

namespace {

void write_kitti(std::ostream& out, const StampedPoses& trajectory) {
  for (const auto& x : trajectory) {
    const Eigen::Matrix3d R = x.q.toRotationMatrix();
    for (int i = 0; i < 3; ++i)
      out << R(i, 0) << ' ' << R(i, 1) << ' ' << R(i, 2) << ' ' << x.p[i] << (i < 2 ? ' ' : '\n');
  }
}

void write_csv(std::ostream& out, const StampedPoses& trajectory) {
  out << "t_ns,x_m,y_m,z_m,qw,qx,qy,qz\n";
  for (const auto& x : trajectory)
    out << x.t_ns << ',' << x.p.x() << ',' << x.p.y() << ',' << x.p.z() << ',' << x.q.w() << ',' << x.q.x() << ','
        << x.q.y() << ',' << x.q.z() << '\n';
}

/// Formats a Unix time as "2026-11-25T10:11:12.345Z".
std::string iso_time(int64_t unix_ns) {
  const std::time_t whole = unix_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&whole, &utc);
  char text[40];
  const size_t size = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text + size, sizeof text - size, ".%03dZ", static_cast<int>(unix_ns / 1'000'000 % 1000));
  return text;
}

void write_gpx(std::ostream& out, const StampedPoses& trajectory, const ToGeodetic& to_geodetic) {
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"Odograph\" "
         "xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>Odograph</name><trkseg>\n";
  for (const auto& x : trajectory) {
    const auto g = to_geodetic(x.p);
    out << "<trkpt lat=\"" << g[0] * kDeg_per_rad << "\" lon=\"" << g[1] * kDeg_per_rad << "\"><ele>" << g[2]
        << "</ele>";
    if (is_unix_time(x.t_ns)) out << "<time>" << iso_time(x.t_ns) << "</time>";
    out << "</trkpt>\n";
  }
  out << "</trkseg></trk>\n</gpx>\n";
}

/// With times, a track that viewers can play; otherwise a line.
void write_kml(std::ostream& out, const StampedPoses& trajectory, const ToGeodetic& to_geodetic) {
  const bool timed = !trajectory.empty() && is_unix_time(trajectory.front().t_ns);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\" "
         "xmlns:gx=\"http://www.google.com/kml/ext/2.2\"><Document><Placemark><name>Odograph</name>"
      << (timed ? "<gx:Track><altitudeMode>absolute</altitudeMode>\n"
                : "<LineString><tessellate>1</tessellate><coordinates>\n");
  for (const auto& x : trajectory)
    if (timed) out << "<when>" << iso_time(x.t_ns) << "</when>\n";
  for (const auto& x : trajectory) {
    const auto g = to_geodetic(x.p);
    if (timed)
      out << "<gx:coord>" << g[1] * kDeg_per_rad << ' ' << g[0] * kDeg_per_rad << ' ' << g[2] << "</gx:coord>\n";
    else
      out << g[1] * kDeg_per_rad << ',' << g[0] * kDeg_per_rad << ',' << g[2] << '\n';
  }
  out << (timed ? "</gx:Track>" : "</coordinates></LineString>") << "</Placemark></Document></kml>\n";
}

/// Times as `coordTimes`, as GPX converters write them.
void write_geojson(std::ostream& out, const StampedPoses& trajectory, const ToGeodetic& to_geodetic) {
  out << "{\"type\":\"Feature\",\"properties\":{\"name\":\"Odograph\"";
  if (!trajectory.empty() && is_unix_time(trajectory.front().t_ns)) {
    out << ",\"coordTimes\":[";
    for (size_t i = 0; i < trajectory.size(); ++i) out << (i ? ",\n\"" : "\n\"") << iso_time(trajectory[i].t_ns) << '"';
    out << ']';
  }
  out << "},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[";
  for (size_t i = 0; i < trajectory.size(); ++i) {
    const auto g = to_geodetic(trajectory[i].p);
    out << (i ? ",\n" : "\n") << '[' << g[1] * kDeg_per_rad << ',' << g[0] * kDeg_per_rad << ',' << g[2] << ']';
  }
  out << "]}}\n";
}

}  // namespace

Result<bool> write_trajectory(const std::filesystem::path& path, const StampedPoses& trajectory,
                              const ToGeodetic& to_geodetic) {
  const std::string kind = path.extension().string();
  const bool on_earth = kind == ".gpx" || kind == ".kml" || kind == ".geojson";
  if (!on_earth && kind != ".tum" && kind != ".txt" && kind != ".kitti" && kind != ".csv")
    return Failure{ODO_E_UNSUPPORTED, path.string() + ": unknown format '" + kind +
                                          "'; expected .tum, .txt, .kitti, .csv, .gpx, .kml or .geojson"};
  if (on_earth && !to_geodetic)
    return Failure{ODO_E_UNSUPPORTED,
                   path.string() +
                       ": needs a geodetic origin, and the run had none (no GNSS, no navigation.origin); give --origin "
                       "LATITUDE,LONGITUDE,HEIGHT (degrees, metres)"};
  auto file = OutputFile::create(path);
  if (!file) return file.failure();
  std::ofstream& out = file->stream();
  out << std::setprecision(12);
  if (kind == ".kitti")
    write_kitti(out, trajectory);
  else if (kind == ".csv")
    write_csv(out, trajectory);
  else if (kind == ".gpx")
    write_gpx(out, trajectory, to_geodetic);
  else if (kind == ".kml")
    write_kml(out, trajectory, to_geodetic);
  else if (kind == ".geojson")
    write_geojson(out, trajectory, to_geodetic);
  else
    write_tum(out, trajectory);
  return file->commit();
}

}  // namespace odograph
