// SPDX-License-Identifier: Apache-2.0
//
// Readers of published data sets of walks with a phone without camera: RIDI, IPIN competitions (GetSensorData), Oxford
// step counter, Malmo trundle wheel.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string_view>

#include "sdk/math/gravity.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/number_text.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/text_rows.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

using Vector = std::array<double, 3>;

void add_imu(Recording& recording, int64_t t_ns, uint32_t flags, const Vector& gyro, const Vector& accel) {
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
  imu.header.flags = flags;
  std::copy(gyro.begin(), gyro.end(), imu.gyro_b);
  std::copy(accel.begin(), accel.end(), imu.accel_b);
  recording.add(imu.header);
}

void add_field(Recording& recording, int64_t t_ns, const Vector& microtesla) {
  auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t_ns);
  for (size_t i = 0; i < 3; ++i) m.field_b[i] = microtesla[i] * 1e-6;
  recording.add(m.header);
}

/// The fields of a line between separators, including empty ones.
std::vector<std::string_view> split_at(std::string_view line, char separator) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (size_t from = 0;;) {
    const size_t to = std::min(line.find(separator, from), line.size());
    fields.push_back(line.substr(from, to - from));
    if (to == line.size()) return fields;
    from = to + 1;
  }
}

/// NaN if it is not a number.
double number_or_nan(std::string_view text) {
  const auto value = parse_number(text);
  return value && std::isfinite(*value) ? *value : std::nan("");
}

/// Lines of fields, of any number per line: these sets omit missing values.
Result<bool> read_lines(const fs::path& path, char separator, const std::function<Result<bool>(const TextRow&)>& take) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be read"};
  std::string line;
  for (int number = 1; std::getline(file, line); ++number)
    if (const auto taken = take({split_at(line, separator), &path, number}); !taken) return taken.failure();
  return true;
}

/// Columns of a CSV file by the names in its head; NaN where a row has none.
Result<bool> read_columns(const fs::path& path, char separator, const std::vector<std::string>& names,
                          const std::function<Result<bool>(const std::vector<double>&, const TextRow&)>& take) {
  std::vector<size_t> columns;
  std::vector<double> values(names.size());
  return read_lines(path, separator, [&](const TextRow& row) -> Result<bool> {
    if (row.line == 1) {
      for (const std::string& name : names) {
        const auto found = std::find(row.fields.begin(), row.fields.end(), name);
        if (found == row.fields.end()) return row.wrong("no column '" + name + "'");
        columns.push_back(static_cast<size_t>(found - row.fields.begin()));
      }
      return true;
    }
    for (size_t i = 0; i < columns.size(); ++i)
      values[i] = columns[i] < row.fields.size() ? number_or_nan(row.fields[columns[i]]) : std::nan("");
    return take(values, row);
  });
}

Vector three(const std::vector<double>& v, size_t from) { return {v[from], v[from + 1], v[from + 2]}; }
bool finite(const Vector& v) { return std::isfinite(v[0] + v[1] + v[2]); }

Result<int64_t> time_of(double seconds, const TextRow& row) {
  if (std::isfinite(seconds) && std::abs(seconds) < 4e9) return nanoseconds(seconds);
  return row.wrong("the time is no number or out of range");
}

Result<Recording> complete(Recording&& recording, const Result<bool>& read) {
  if (!read) return read.failure();
  if (!recording.has(ODO_TYPE_IMU))
    return Failure{ODO_E_DATA, recording.path.string() + ": no acceleration and rotation rate in it"};
  recording.sort();
  return std::move(recording);
}

}  // namespace

Result<Recording> read_ridi(const fs::path& file) {
  Recording recording{.format = "RIDI", .path = file};
  const auto done = read_columns(
      file, ',',
      {"time_s", "gyro_x", "gyro_y", "gyro_z", "acce_x", "acce_y", "acce_z", "magnet_x", "magnet_y", "magnet_z",
       "pos_x", "pos_y", "pos_z", "ori_w", "ori_x", "ori_y", "ori_z"},
      [&](const std::vector<double>& v, const TextRow& row) -> Result<bool> {
        const auto t_ns = time_of(v[0], row);
        if (!t_ns) return t_ns.failure();
        if (finite(three(v, 1)) && finite(three(v, 4)))
          add_imu(recording, *t_ns, ODO_IMU_GYRO | ODO_IMU_ACCEL, three(v, 1), three(v, 4));
        if (finite(three(v, 7))) add_field(recording, *t_ns, three(v, 7));
        const Eigen::Quaterniond q_w_b(v[13], v[14], v[15], v[16]);
        if (!finite(three(v, 10)) || !(std::abs(q_w_b.norm() - 1) < 0.01)) return true;
        const Eigen::Quaterniond q_n_w(0, std::sqrt(0.5), std::sqrt(0.5), 0);  // w: z up; its y is treated as north
        recording.truth.push_back({*t_ns, (q_n_w * q_w_b).normalized(), q_n_w * Eigen::Vector3d(v[10], v[11], v[12])});
        return true;
      });
  return complete(std::move(recording), done);
}

Result<Recording> read_get_sensor_data(const fs::path& file) {
  Recording recording{.format = "IPIN", .path = file};
  double first_latitude = std::nan(""), first_longitude = std::nan("");
  std::map<std::string, double, std::less<>> offsets_s;  // of each sensor's clock: the app's has jitter
  const auto done = read_lines(file, ';', [&](const TextRow& row) -> Result<bool> {
    const std::string_view type = row.fields[0];
    const bool place = type == "POSI", air = type.starts_with("PRE");
    if (type != "ACCE" && type != "GYRO" && type != "MAGN" && !air && !place) return true;
    std::vector<double> v;
    for (size_t i = 1; i < (air ? 4u : 6u); ++i) {
      const auto value = row.number(i);
      if (!value) return value.failure();
      v.push_back(*value);
    }
    const auto t_ns =
        time_of(place ? v[0] : v[1] + offsets_s.try_emplace(std::string(type), v[0] - v[1]).first->second, row);
    if (!t_ns) return t_ns.failure();
    if (air) {
      auto m = make_message<odo_barometer>(ODO_TYPE_BAROMETER, *t_ns);
      m.pressure_pa = 100 * v[2];
      recording.add(m.header);
    } else if (place) {
      if (std::isnan(first_latitude)) first_latitude = v[2], first_longitude = v[3];
      constexpr double kEarth_m = 6371008.8;
      auto m = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, *t_ns);
      m.p_n[0] = (v[2] - first_latitude) * kRad_per_deg * kEarth_m;
      m.p_n[1] = (v[3] - first_longitude) * kRad_per_deg * kEarth_m * std::cos(first_latitude * kRad_per_deg);
      m.sigma_m = 0.5;
      recording.add(m.header);
      recording.true_floors.push_back({*t_ns, static_cast<int>(std::lround(v[4]))});
    } else if (type == "MAGN") {
      add_field(recording, *t_ns, three(v, 2));
    } else {
      const bool gyro = type == "GYRO";
      add_imu(recording, *t_ns, gyro ? ODO_IMU_GYRO : ODO_IMU_ACCEL, gyro ? three(v, 2) : Vector{},
              gyro ? Vector{} : three(v, 2));
    }
    return true;
  });
  return complete(std::move(recording), done);
}

Result<Recording> read_oxford_steps(const fs::path& accelerometer) {
  Recording recording{.format = "Oxford steps", .path = accelerometer};
  const auto done = read_rows(accelerometer, [&](const TextRow& row) -> Result<bool> {
    const auto t_ns = row.time_ns(0);
    const auto v = numbers(row, 5);
    if (!t_ns) return t_ns.failure();
    if (!v) return v.failure();
    // These phones' gyroscopes were not recorded: zero rotation replaces them, because there is no attitude without a
    // gyroscope.
    add_imu(recording, *t_ns, ODO_IMU_GYRO | ODO_IMU_ACCEL, {}, three(*v, 2));
    return true;
  });
  if (!done) return done.failure();
  std::string name = accelerometer.filename().string();
  name.replace(name.rfind("accelerometer"), std::string::npos, "stepcounter.csv");
  // One switch in each shoe; each rising edge is a contact.
  std::array<int64_t, 2> before{1, 1};
  int64_t last_ns = INT64_MIN;
  const auto steps = read_rows(accelerometer.parent_path() / name, [&](const TextRow& row) -> Result<bool> {
    const auto t_ns = row.time_ns(0);
    if (!t_ns) return t_ns.failure();
    for (size_t foot : {0, 1}) {
      const auto on = row.integer(1 + foot);
      if (!on) return on.failure();
      if (*on != 0 && before[foot] == 0) {
        auto step = make_message<odo_step>(ODO_TYPE_STEP, *t_ns);
        step.t_start_ns = last_ns == INT64_MIN ? *t_ns : last_ns, step.t_end_ns = *t_ns;
        recording.true_steps.push_back(step);
        last_ns = *t_ns;
      }
      before[foot] = *on;
    }
    return true;
  });
  return complete(std::move(recording), steps);
}

namespace {

struct WheelSample {
  int64_t t_ns;
  Vector gyro, accel;
};

/// The acceleration "including gravity" of this set's browser has a scale error of 4 to 16 %: the median norm is
/// brought to gravity.
void add_normalised(Recording& recording, const std::vector<WheelSample>& samples) {
  std::vector<double> norms;
  for (const WheelSample& s : samples) norms.push_back(Eigen::Vector3d(s.accel.data()).norm());
  if (norms.empty()) return;
  const auto median = norms.begin() + static_cast<long>(norms.size() / 2);
  std::nth_element(norms.begin(), median, norms.end());
  const double scale = *median > 0 ? kStandardGravity_mps2 / *median : 1.0;
  for (const WheelSample& s : samples)
    add_imu(recording, s.t_ns, ODO_IMU_GYRO | ODO_IMU_ACCEL, s.gyro,
            {scale * s.accel[0], scale * s.accel[1], scale * s.accel[2]});
}

/// Latitude and longitude in degrees, accuracy in metres: the rms of both axes together.
void add_place(Recording& recording, int64_t t_ns, const Vector& place) {
  auto m = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
  m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
  m.latitude_rad = kRad_per_deg * place[0], m.longitude_rad = kRad_per_deg * place[1];
  m.covariance_n[0] = m.covariance_n[4] = 0.5 * place[2] * place[2];
  m.covariance_n[8] = 4 * place[2] * place[2];
  recording.add(m.header);
}

}  // namespace

Result<Recording> read_trundle_wheel(const fs::path& file) {
  Recording recording{.format = "Trundle wheel", .path = file};
  std::vector<std::string> names{"time",           "m_accG_x",        "m_accG_y", "m_accG_z", "m_rotTate_alpha",
                                 "m_rotTate_beta", "m_rotTate_gamma", "distance"};
  std::string head;
  std::ifstream stream(file, std::ios::binary);
  std::getline(stream, head);
  const bool places = head.find("p_lat;p_long;p_alt;p_acc") != std::string::npos;
  if (places) names.insert(names.end(), {"p_lat", "p_long", "p_acc"});
  std::vector<WheelSample> samples;
  const auto done =
      read_columns(file, ';', names, [&](const std::vector<double>& v, const TextRow& row) -> Result<bool> {
        // A fix has the receiver's clock: it counts as of the motion sample before it.
        if (places && finite(three(v, 8)) && v[10] > 0) {
          if (!samples.empty()) add_place(recording, samples.back().t_ns, three(v, 8));
          return true;
        }
        const auto t_ns = time_of(1e-3 * v[0], row);
        if (!t_ns) return t_ns.failure();
        if (finite(three(v, 1)) && finite(three(v, 4)))
          samples.push_back({*t_ns, {kRad_per_deg * v[4], kRad_per_deg * v[5], kRad_per_deg * v[6]}, three(v, 1)});
        if (std::isfinite(v[7])) recording.true_distances.push_back({*t_ns, v[7]});
        return true;
      });
  add_normalised(recording, samples);
  return complete(std::move(recording), done);
}

std::optional<Result<Recording>> read_walk(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  if (!stream || !std::getline(stream, line)) return std::nullopt;
  const auto has = [&](std::string_view what) { return line.find(what) != std::string::npos; };
  if (file.extension() == ".txt") {
    while (line.starts_with('%') && std::getline(stream, line)) {
    }
    const bool four_letters = line.size() > 4 && line[4] == ';' &&
                              std::all_of(line.begin(), line.begin() + 4, [](char c) { return c >= 'A' && c <= 'Z'; });
    return four_letters ? std::optional(read_get_sensor_data(file)) : std::nullopt;
  }
  if (file.extension() != ".csv") return std::nullopt;
  if (has("acce_x") && has("pos_x")) return read_ridi(file);
  if (has("m_accG_x") && has("distance")) return read_trundle_wheel(file);
  if (file.filename().string().ends_with("_accelerometer.csv")) return read_oxford_steps(file);
  return std::nullopt;
}

}  // namespace odograph
