// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/read_phone.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "sdk/math/scalar.hpp"
#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/phone_camera.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace phone {
namespace {

struct Parameters {
  size_t max_names = 200'000;     ///< maximum number of files in a folder
  double gravity_low_mps2 = 8.8;  ///< of an accelerometer's median norm: gravity with a scale error
  double gravity_high_mps2 = 10.8;
  double no_gravity_mps2 = 5;      ///< below it: without gravity, or in g; walking without gravity has 1 to 4
  double slow_hz = 50;             ///< below it, a step has only a few samples
  double stale_fix_s = 2;          ///< fixes older than the start by more are cached ones
  double silence_s = 0.5;          ///< gap of an inertial sensor that is reported
  double max_gravity_age_s = 0.1;  ///< between an acceleration and the gravity sample added to it
};
constexpr Parameters kParameters;

std::string hertz(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f Hz", value);
  return text;
}

class Reading {
 public:
  Reading(const Format& format, Files files) : format_(format), files_(std::move(files)) {
    recording_.format = format.name;
    recording_.path = files_.folder;
  }

  Result<Recording> run() {
    using Step = Result<bool> (Reading::*)();
    for (const Step step :
         {&Reading::read_metadata, &Reading::read_all, &Reading::put_gravity_back, &Reading::check_inertial,
          &Reading::add_sensors, &Reading::add_places, &Reading::add_frames, &Reading::add_poses})
      if (const auto done = (this->*step)(); !done) return done.failure();
    describe_at_first_sample();
    recording_.sort();
    return std::move(recording_);
  }

 private:
  Failure wrong(const std::string& text) const { return {ODO_E_DATA, files_.folder.string() + ": " + text}; }
  void warn(const std::string& text) { recording_.warnings.push_back(text); }
  Rows* rows_of(Stream stream) {
    const auto found = read_.find(stream);
    return found == read_.end() || found->second.rows.empty() ? nullptr : &found->second;
  }

  /// At the time of the first sample, before it: a description at time 0 would be decades earlier.
  void describe_at_first_sample() {
    auto& messages = recording_.messages;
    const auto describes = [](const RecordedMessage& m) { return m.message.header().type == ODO_TYPE_CALIBRATION; };
    const auto samples = std::stable_partition(messages.begin(), messages.end(), describes);
    int64_t first_ns = INT64_MAX;
    for (auto m = samples; m != messages.end(); ++m) first_ns = std::min(first_ns, m->message.header().t_ns);
    for (auto m = messages.begin(); m != samples; ++m) m->message.header().t_ns = first_ns;
  }

  /// Sensor Logger's Metadata.csv: platform and conventions.
  Result<bool> read_metadata() {
    if (files_.find("Metadata.csv").empty()) {
      if (std::string(format_.name) == "Sensor Logger")
        warn("no Metadata.csv: treated as an Android phone's; export the whole recording, an iPhone's signs differ");
      return true;
    }
    const auto metadata = metadata_of(files_.folder / "Metadata.csv");
    const auto value_of = [&](const char* name) {
      const auto found = metadata.find(name);
      return found == metadata.end() ? std::string() : found->second;
    };
    std::string platform = value_of("platform");
    std::transform(platform.begin(), platform.end(), platform.begin(), [](unsigned char c) { return std::tolower(c); });
    device_ = value_of("device name");
    if (platform != "ios" && platform != "android")
      return wrong("Metadata.csv, column 'platform': '" + platform.substr(0, 40) + "'; expected ios or android");
    apple_ = platform == "ios";
    const std::string standardised = value_of("standardisation");
    if (apple_ && standardised.empty())
      warn("Metadata.csv has no column 'standardisation' (older versions of the app): treated as off, iOS's own signs");
    apple_axes_ = apple_ && !standardised.starts_with("true");
    recording_.format += apple_ ? " (iOS)" : " (Android)";
    return true;
  }

  bool fits(const Table& table) const { return table.when == When::any || (table.when == When::apple) == apple_axes_; }

  /// For each stream, the first table that has rows.
  Result<bool> read_all() {
    std::map<std::string, std::vector<Rows>> by_file;
    std::vector<std::pair<std::string, size_t>> order;  // of the format's tables
    for (const Table& table : format_.tables) {
      const std::string name = fits(table) ? files_.find(table.file) : std::string();
      if (name.empty()) continue;
      by_file[name].push_back({&table, {}, {}});
      order.emplace_back(name, by_file[name].size() - 1);
    }
    for (auto& [name, tables] : by_file)
      if (const auto done = read_tables(format_.layout, files_.folder / name, tables); !done) return done.failure();
    for (const auto& [name, i] : order) {
      Rows& rows = by_file[name][i];
      const Stream stream = rows.table->stream;
      if (!rows.missing_column.empty())
        missing_[stream] = name + " has no column '" + rows.missing_column + "'";
      else if (rows.rows.empty())
        missing_.try_emplace(stream, name + " has no rows of it");
      else if (read_.find(stream) == read_.end())
        read_.emplace(stream, std::move(rows));
    }
    for (auto& [stream, rows] : read_)
      if (rows.incomplete > 0)
        warn(rows.file.filename().string() + ": " + std::to_string(rows.incomplete) +
             " rows with missing values skipped");
    return shift_to_unix();
  }

  /// Converts all times to Unix time if the app writes both clocks; tracks on a map need it.
  Result<bool> shift_to_unix() {
    std::vector<int64_t> offsets;
    for (const auto& [stream, rows] : read_)
      for (const Row& row : rows.rows)
        if (!rows.table->has_unix_time_alone() && row.unix_ns != 0 && is_plausible_time(row.unix_ns - row.t_ns))
          offsets.push_back(row.unix_ns - row.t_ns);
    for (auto& [stream, rows] : read_)
      if (offsets.empty() && rows.table->has_unix_time_alone())
        missing_[stream] = "in Unix time, which the other sensors lack", rows.rows.clear();
    if (offsets.empty()) return true;
    const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
    std::nth_element(offsets.begin(), middle, offsets.end());
    for (auto& [stream, rows] : read_)
      if (!rows.table->has_unix_time_alone())
        for (Row& row : rows.rows) row.t_ns += *middle;
    return true;
  }

  Result<bool> put_gravity_back() {
    if (rows_of(Stream::accel) || !rows_of(Stream::linear_accel)) return true;
    Rows& accel = *rows_of(Stream::linear_accel);
    Rows* gravity = rows_of(Stream::gravity);
    if (!gravity)
      return wrong(accel.file.filename().string() + " is without gravity, and there is no Gravity.csv" +
                   (apple_ ? "" : " and no TotalAcceleration.csv") + "; in " + format_.name + ": " +
                   format_.switch_on_accel);
    const auto earlier = [](const Row& a, const Row& b) { return a.t_ns < b.t_ns; };
    std::stable_sort(gravity->rows.begin(), gravity->rows.end(), earlier);
    std::vector<Row> whole;
    for (Row row : accel.rows) {
      const auto after = std::lower_bound(gravity->rows.begin(), gravity->rows.end(), row, earlier);
      const Row& b = after == gravity->rows.end() ? gravity->rows.back() : *after;
      const Row& a = after == gravity->rows.begin() || b.t_ns == row.t_ns ? b : *(after - 1);
      if (std::min(std::abs(seconds(row.t_ns - a.t_ns)), std::abs(seconds(b.t_ns - row.t_ns))) >
          kParameters.max_gravity_age_s)
        continue;
      const double part =
          b.t_ns > a.t_ns ? std::clamp(seconds(row.t_ns - a.t_ns) / seconds(b.t_ns - a.t_ns), 0.0, 1.0) : 0;
      for (size_t i = 0; i < 3; ++i)
        row.v[i] = row.v[i] * accel.table->scale + ((1 - part) * a.v[i] + part * b.v[i]) * gravity->table->scale;
      whole.push_back(row);
    }
    if (whole.empty()) return wrong("Gravity.csv has no rows at the times of " + accel.file.filename().string());
    static const Table kWhole{Stream::accel, "", "", TimeUnit::nanoseconds, {}, 1, When::any, ODO_IMU_ACCEL_CORRECTED};
    read_[Stream::accel] = {&kWhole, accel.file, std::move(whole)};
    return true;
  }

  /// Checks both sensors, the magnitude of gravity, rates and gaps.
  Result<bool> check_inertial() {
    for (const auto& [stream, switch_on] :
         {std::pair{Stream::gyro, format_.switch_on_gyro}, {Stream::accel, format_.switch_on_accel}}) {
      Rows* rows = rows_of(stream);
      if (!rows) {
        const auto why = missing_.find(stream);
        return wrong(std::string("no ") + name_of(stream) + (why == missing_.end() ? "" : " (" + why->second + ")") +
                     "; in " + format_.name + ": " + switch_on);
      }
      check_rate(*rows);
    }
    Rows& accel = *rows_of(Stream::accel);
    std::vector<double> lengths;
    for (const Row& row : accel.rows) lengths.push_back(std::hypot(row.v[0], row.v[1], row.v[2]));
    std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
    double scale = accel.table->scale, length = lengths[lengths.size() / 2];
    if (scale == kByGravity) {
      const bool in_g = length < 2;
      scale = in_g ? -kStandardGravity_mps2 : -1;
      warn(accel.file.filename().string() + ": accelerations treated as " + (in_g ? "g" : "m/s^2") +
           " with iOS's sign, by the magnitude of gravity");
    }
    accel_scale_ = scale, length *= std::abs(scale);
    if (length >= kParameters.gravity_low_mps2 && length <= kParameters.gravity_high_mps2) return true;
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", length);
    const std::string what = accel.file.filename().string() + ": accelerations have a median norm of " + text +
                             " m/s^2 where gravity is 9.8";
    if (length > kParameters.no_gravity_mps2) {  // a phone that is shaken throughout
      warn(what + ": shaken, or another unit?");
      return true;
    }
    const bool in_g = length > 0.8 && length < 1.2;
    return wrong(what + (in_g ? ": in g?" : ": without gravity?") + " In " + format_.name + ": " +
                 format_.switch_on_accel);
  }

  void check_rate(Rows& rows) {
    std::stable_sort(rows.rows.begin(), rows.rows.end(), [](const Row& a, const Row& b) { return a.t_ns < b.t_ns; });
    const size_t n = rows.rows.size();
    const double span_s = seconds(rows.rows.back().t_ns - rows.rows.front().t_ns);
    const std::string name = rows.file.filename().string() + " (" + name_of(rows.table->stream) + ")";
    if (n > 1 && span_s > 0 && static_cast<double>(n - 1) / span_s < kParameters.slow_hz)
      warn(name + " has " + hertz(static_cast<double>(n - 1) / span_s) +
           "; 100 Hz and more are better: set the app to its fastest sampling");
    double silence_s = 0;
    for (size_t i = 1; i < n; ++i) silence_s = std::max(silence_s, seconds(rows.rows[i].t_ns - rows.rows[i - 1].t_ns));
    char text[32];
    std::snprintf(text, sizeof text, "%.1f s", silence_s);
    if (silence_s > kParameters.silence_s) warn(name + " is silent for up to " + text);
  }

  /// Inertial samples, combined if both are simultaneous; magnetometer; barometer.
  Result<bool> add_sensors() {
    const Rows &gyro = *rows_of(Stream::gyro), &accel = *rows_of(Stream::accel);
    size_t a = 0;
    const auto add_accel = [&](const Row& row) {
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, row.t_ns);
      imu.header.flags = ODO_IMU_ACCEL | accel.table->flags;
      for (size_t i = 0; i < 3; ++i) imu.accel_b[i] = accel_scale_ * row.v[i];
      recording_.add(imu.header);
    };
    for (const Row& row : gyro.rows) {
      while (a < accel.rows.size() && accel.rows[a].t_ns < row.t_ns) add_accel(accel.rows[a++]);
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, row.t_ns);
      imu.header.flags = ODO_IMU_GYRO | gyro.table->flags;
      for (size_t i = 0; i < 3; ++i) imu.gyro_b[i] = gyro.table->scale * row.v[i];
      if (a < accel.rows.size() && accel.rows[a].t_ns == row.t_ns) {
        imu.header.flags |= ODO_IMU_ACCEL | accel.table->flags;
        for (size_t i = 0; i < 3; ++i) imu.accel_b[i] = accel_scale_ * accel.rows[a].v[i];
        ++a;
      }
      recording_.add(imu.header);
    }
    while (a < accel.rows.size()) add_accel(accel.rows[a++]);
    if (const Rows* field = rows_of(Stream::field))
      for (const Row& row : field->rows) {
        auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, row.t_ns);
        m.header.flags = field->table->flags;
        for (size_t i = 0; i < 3; ++i) m.field_b[i] = field->table->scale * row.v[i];
        recording_.add(m.header);
      }
    if (const Rows* pressure = rows_of(Stream::pressure))
      for (const Row& row : pressure->rows) {
        auto m = make_message<odo_barometer>(ODO_TYPE_BAROMETER, row.t_ns);
        m.pressure_pa = pressure->table->scale * row.v[0];
        recording_.add(m.header);
      }
    return warn_of_missing();
  }

  Result<bool> warn_of_missing() {
    std::string lacking;
    for (const Stream stream : {Stream::field, Stream::pressure, Stream::place}) {
      const bool possible = std::any_of(format_.tables.begin(), format_.tables.end(),
                                        [&](const Table& table) { return table.stream == stream; });
      if (!possible || rows_of(stream)) continue;
      lacking += (lacking.empty() ? "" : ", ") + std::string(name_of(stream));
      if (const auto why = missing_.find(stream); why != missing_.end()) lacking += " (" + why->second + ")";
    }
    if (!lacking.empty()) warn("not recorded: " + lacking + "; " + format_.name + " has " + format_.switch_on_others);
    return true;
  }

  /// Fixes, without those cached before the recording.
  Result<bool> add_places() {
    const Rows* places = rows_of(Stream::place);
    if (!places) return true;
    const int64_t start_ns = recording_.messages.front().message.header().t_ns;
    const int64_t end_ns = rows_of(Stream::gyro)->rows.back().t_ns;
    size_t stale = 0, odd = 0, ahead = 0;
    for (const Row& row : places->rows) {
      if (seconds(row.t_ns - end_ns) > kParameters.stale_fix_s) {
        ++ahead;
        continue;
      }
      if (seconds(start_ns - row.t_ns) > kParameters.stale_fix_s) {
        ++stale;
        continue;
      }
      const auto& v = row.v;
      auto m = make_message<odo_gnss>(ODO_TYPE_GNSS, row.t_ns);
      m.header.flags = ODO_GNSS_POSITION;
      m.latitude_rad = v[0] * kRad_per_deg, m.longitude_rad = v[1] * kRad_per_deg;
      const bool has_height = std::isfinite(v[2]) && !(v[4] < 0);
      if (has_height) m.height_m = v[2], m.header.flags |= ODO_GNSS_HEIGHT;
      if (v[3] < 0 || !message_is_good(m.header)) {  // the platforms mark an invalid fix in this way
        ++odd;
        continue;
      }
      if (v[3] > 0) {  // the radius is the rms of both axes together
        m.header.flags |= ODO_GNSS_COVARIANCE;
        m.covariance_n[0] = m.covariance_n[4] = 0.5 * v[3] * v[3];
        const double sigma_height = v[4] > 0 ? v[4] : 2 * v[3];
        m.covariance_n[8] = sigma_height * sigma_height;
      }
      recording_.add(m.header);
    }
    const std::string name = places->file.filename().string();
    if (stale > 0) warn(name + ": " + std::to_string(stale) + " fixes are older than the recording and skipped");
    if (ahead > 0) warn(name + ": " + std::to_string(ahead) + " fixes are newer than the recording and skipped");
    if (odd > 0) warn(name + ": " + std::to_string(odd) + " fixes are marked as invalid and skipped");
    return true;
  }

  Result<bool> add_frames() {
    auto facts = camera_facts(files_, recording_.warnings);
    if (!facts) return facts.failure();
    facts->apple = apple_ || std::string(format_.name) == "Stray Scanner";
    facts->device = device_;
    if (!rows_of(Stream::frame) && missing_.count(Stream::frame) && *format_.video)
      return wrong(missing_[Stream::frame] + "; in " + format_.name + ": " + format_.switch_on_video);
    return add_camera(recording_, format_, files_, rows_of(Stream::frame), *facts);
  }

  /// The platform's own poses as reference: y up is converted to n, with north along the phone's first view.
  Result<bool> add_poses() {
    const Rows* poses = rows_of(Stream::pose);
    if (!poses) return true;
    Eigen::Matrix3d R_n_w;
    R_n_w << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    for (const Row& row : poses->rows) {
      const auto& v = row.v;
      const Eigen::Quaterniond q_w_c(v[6], v[3], v[4], v[5]);
      const Eigen::Vector3d p(v[0], v[1], v[2]);
      if (!(std::abs(q_w_c.norm() - 1) < 0.01) || !is_plausible_time(row.t_ns)) continue;
      recording_.truth.push_back({row.t_ns, Eigen::Quaterniond(R_n_w) * q_w_c.normalized(), R_n_w * p});
    }
    warn("the reference is the platform's own tracking, which drifts too");
    return true;
  }

  const Format& format_;
  Files files_;
  Recording recording_;
  std::map<Stream, Rows> read_;
  std::map<Stream, std::string> missing_;
  std::string device_;
  double accel_scale_ = 1;
  bool apple_ = false, apple_axes_ = false;
};

}  // namespace
}  // namespace phone

bool looks_like_phone_recording(const fs::path& folder) {
  return phone::format_of(phone::files_of(folder, {})) != nullptr;
}

bool looks_like_gnss_log(const fs::path& file) {
  if (file.extension() != ".txt") return false;
  std::ifstream in(file, std::ios::binary);
  std::string line;
  for (int i = 0; i < 100 && line.size() < 4096 && std::getline(in, line); ++i)
    if (line.starts_with("# Fix,") || line.starts_with("# UncalAccel,") || line.starts_with("# Raw,")) return true;
  return false;
}

Result<Recording> read_gnss_log(const fs::path& file) {
  for (const phone::Format& format : phone::formats())
    if (format.layout == phone::Layout::named_rows) {
      phone::Files files{file.parent_path().empty() ? "." : file.parent_path(), {}, {file.filename().string()}};
      auto recording = phone::Reading(format, std::move(files)).run();
      if (recording) recording->path = file;
      return recording;
    }
  return Failure{ODO_E_UNSUPPORTED, file.string() + ": unknown"};
}

Result<Recording> read_phone(const fs::path& path, std::shared_ptr<const void> keep) {
  phone::Files files = phone::files_of(path, std::move(keep));
  const phone::Format* format = phone::format_of(files);
  if (!format) return Failure{ODO_E_DATA, path.string() + ": none of the apps' recordings"};
  return phone::Reading(*format, std::move(files)).run();
}

}  // namespace odograph
