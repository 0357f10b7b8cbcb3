// SPDX-License-Identifier: Apache-2.0
//
// `odograph city locate`: places single photographs in a city model.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/tools/city/photograph.hpp"
#include "sdk/tools/city/photograph_drawing.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/table/table.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = 0.017453292519943295;
constexpr double kSigma_m = 10, kHeadingSigma_deg = 20;  // of a phone's GNSS and compass between houses
constexpr double kDeclination_deg = 10;  // sigma of the declination, unknown here; beyond 30 only near the poles

struct LocateArguments {
  std::vector<std::string> pictures;
  std::string model, near, model_at, lens, output = "out/locate";
  std::vector<double> at;
  double sigma_m = 0, heading_deg = NAN, heading_sigma_deg = kHeadingSigma_deg;
  bool any_heading = false, json = false;
};

Result<std::array<double, 2>> place_of(const std::string& option, const std::string& words) {
  std::array<double, 2> place{};
  char rest = 0;
  if (std::sscanf(words.c_str(), "%lf ,%lf %c", &place[0], &place[1], &rest) != 2 || std::abs(place[0]) > 90 ||
      std::abs(place[1]) > 180)
    return Failure{ODO_E_ARGUMENT,
                   option + " " + words + ": expected latitude,longitude in degrees, as 48.3035,14.2875"};
  return place;
}

/// The picture files, including those in folders.
Result<std::vector<fs::path>> files_of(const std::vector<std::string>& names) {
  std::vector<fs::path> files;
  for (const std::string& name : names) {
    if (!fs::is_directory(name)) {
      files.emplace_back(name);
      continue;
    }
    const auto before = static_cast<std::ptrdiff_t>(files.size());
    for (const auto& entry : fs::directory_iterator(name)) {
      std::string ending = entry.path().extension().string();
      for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      if (ending == ".jpg" || ending == ".jpeg" || ending == ".png") files.push_back(entry.path());
    }
    std::sort(files.begin() + before, files.end());
    if (static_cast<std::ptrdiff_t>(files.size()) == before)
      return Failure{ODO_E_NOT_FOUND, name + ": no pictures in it (jpg, png)"};
  }
  return files;
}

/// Origin of n, and transformation of geodetic positions to n.
class Frame {
 public:
  static Result<Frame> of(const LocateArguments& a, const std::vector<Photograph>& photographs) {
    Frame frame;
    if (!a.at.empty()) {
      frame.origin_.model = {a.at[0], a.at[1], 0};
      frame.in_model_ = true;
      return frame;
    }
    std::optional<std::array<double, 2>> origin;
    if (!a.near.empty()) {
      const auto near = place_of("--near", a.near);
      if (!near) return near.failure();
      frame.near_ = origin = *near;
    }
    for (const Photograph& p : photographs)
      if (!origin) origin = p.place_deg;
    if (!a.model_at.empty()) {
      const auto zero = place_of("--model-at", a.model_at);
      if (!zero) return zero.failure();
      origin = *zero;
    }
    if (!origin)
      return Failure{ODO_E_ARGUMENT,
                     "where were they taken? The pictures do not say (no GPS in EXIF): give --near LAT,LON"};
    if (a.model_at.empty()) frame.origin_.geodetic_deg = origin;
    frame.geodesy_ = std::make_shared<Geodesy>();
    frame.geodesy_->set_origin({(*origin)[0] * kDegree, (*origin)[1] * kDegree, 0});
    return frame;
  }

  const PhotographOrigin& origin() const { return origin_; }
  /// The prior of a photograph: from the command line, otherwise from its EXIF data.
  std::optional<PhotographGuess> guess_of(const LocateArguments& a, const Photograph& p) const {
    PhotographGuess guess;
    guess.sigma_m = a.sigma_m > 0 ? a.sigma_m : near_ || in_model_ ? kSigma_m : p.place_sigma_m.value_or(kSigma_m);
    if (!in_model_) {
      const auto place = near_ ? near_ : p.place_deg;
      if (!place) return std::nullopt;
      const auto n = geodesy_->from_geodetic({(*place)[0] * kDegree, (*place)[1] * kDegree, 0});
      guess.north_m = n[0], guess.east_m = n[1];
    }
    const double heading = std::isfinite(a.heading_deg) ? a.heading_deg : p.heading_deg.value_or(NAN);
    if (std::isfinite(heading) && !a.any_heading) guess.heading_rad = std::remainder(heading, 360) * kDegree;
    const bool magnetic = !std::isfinite(a.heading_deg) && p.heading_is_magnetic;
    guess.heading_sigma_rad = std::hypot(a.heading_sigma_deg, magnetic ? kDeclination_deg : 0) * kDegree;
    return guess;
  }
  /// A position for output: latitude and longitude, or easting and northing.
  std::array<double, 2> output_coordinates(const Eigen::Vector3d& p_n) const {
    if (in_model_) return {origin_.model.x() + p_n.y(), origin_.model.y() + p_n.x()};
    const auto g = geodesy_->to_geodetic({p_n.x(), p_n.y(), 0});
    return {g[0] / kDegree, g[1] / kDegree};
  }
  bool in_model() const { return in_model_; }

 private:
  PhotographOrigin origin_;
  bool in_model_ = false;
  std::optional<std::array<double, 2>> near_;
  std::shared_ptr<Geodesy> geodesy_;
};

double degrees(double rad) { return std::fmod(rad / kDegree + 360, 360); }

Json row_of(const Photograph& photograph, const Frame& frame, const PhotographPose& placed, double eye_m) {
  Json row = {{"picture", photograph.file.filename().string()}, {"placed", placed.placed}};
  if (!placed.placed) {
    row["reason"] = placed.why;
    return row;
  }
  const auto at = frame.output_coordinates(placed.p_n);
  row[frame.in_model() ? "easting_m" : "latitude_deg"] = at[0];
  row[frame.in_model() ? "northing_m" : "longitude_deg"] = at[1];
  row["sigma_m"] = placed.sigma_m();
  row["height_m"] = -placed.p_n.z();
  row["above_ground_m"] = eye_m;
  row["heading_deg"] = degrees(placed.heading_rad());
  row["heading_sigma_deg"] = placed.heading_sigma_rad / kDegree;
  row["pitch_deg"] = placed.pitch_rad() / kDegree;
  row["roll_deg"] = placed.roll_rad() / kDegree;
  row["agreement"] = placed.agreement;
  row["risk"] = placed.integrity;
  return row;
}

std::string line_of(const Json& row) {
  const auto number = [&](const char* key) { return row[key].get<double>(); };
  const std::string name = row["picture"].get<std::string>();
  if (!row["placed"].get<bool>()) return name + ": not placed: " + row["reason"].get<std::string>();
  const bool grid = row.contains("easting_m");
  const std::string place = grid ? text("easting %.2f, northing %.2f", number("easting_m"), number("northing_m"))
                                 : text("%.7f, %.7f", number("latitude_deg"), number("longitude_deg"));
  return name + ": " + place +
         text(" (sigma %.1f m), looks to %.1f deg (sigma %.1f), %+.1f deg up, rolled by %+.1f; risk %.2f",
              number("sigma_m"), number("heading_deg"), number("heading_sigma_deg"), number("pitch_deg"),
              number("roll_deg"), number("risk"));
}

Result<bool> write_csv(const fs::path& file, const Rows& rows, bool grid) {
  std::ofstream out(file);
  const std::vector<std::string> keys = {"picture",
                                         "placed",
                                         grid ? "easting_m" : "latitude_deg",
                                         grid ? "northing_m" : "longitude_deg",
                                         "sigma_m",
                                         "height_m",
                                         "heading_deg",
                                         "heading_sigma_deg",
                                         "pitch_deg",
                                         "roll_deg",
                                         "agreement",
                                         "risk",
                                         "reason"};
  for (size_t k = 0; k < keys.size(); ++k) out << (k ? "," : "") << keys[k];
  for (const Json& row : rows) {
    out << '\n';
    for (size_t k = 0; k < keys.size(); ++k) {
      out << (k ? "," : "");
      if (row.contains(keys[k])) out << row[keys[k]].dump();
    }
  }
  out << '\n';
  return out.flush() ? Result<bool>(true) : Failure{ODO_E_ERROR, file.string() + ": cannot be written"};
}

/// Warns about missing buildings or terrain of the model.
void print_ground(const PhotographLocalizer& localizer, const PhotographGuess& guess) {
  const auto ground = localizer.ground({guess.north_m, guess.east_m});
  if (!ground)
    std::fprintf(stderr, "odograph: the model has no building within 60 m of the place: is it the right model?\n");
  else if (!ground->terrain)
    std::fprintf(stderr,
                 "odograph: the model has no terrain there: its ground is taken from the lowest corners of the "
                 "buildings around, %.1f m high at the place that was given\n",
                 -ground->down_m);
}

/// The readable pictures; failures of others set `status`.
Result<std::vector<Photograph>> read_all(const std::vector<std::string>& names, int& status) {
  const auto files = files_of(names);
  if (!files) return files.failure();
  std::vector<Photograph> photographs;
  for (const fs::path& file : *files) {
    auto photograph = read_photograph(file);
    if (photograph)
      photographs.push_back(std::move(*photograph));
    else
      status = print_failure(photograph.failure());
  }
  return photographs;
}

Failure with_hint(Failure failure, const Frame& frame) {
  if (frame.origin().geodetic_deg)
    failure.text +=
        "; if it is its reference system: --model-at LAT,LON says where its zero is, --at EASTING NORTHING "
        "takes the place in its own coordinates";
  return failure;
}

int locate(const LocateArguments& a) {
  int status = kDone;
  auto photographs_read = read_all(a.pictures, status);
  if (!photographs_read) return print_failure(photographs_read.failure());
  std::vector<Photograph>& photographs = *photographs_read;
  if (photographs.empty()) return status;
  const auto frame = Frame::of(a, photographs);
  if (!frame) return print_failure(frame.failure());
  auto localizer = PhotographLocalizer::make(a.model, frame->origin());
  if (!localizer) return print_failure(with_hint(localizer.failure(), *frame));
  std::error_code error;
  fs::create_directories(a.output, error);
  if (error) return print_failure({ODO_E_ERROR, a.output + ": no folder can be made there: " + error.message()});
  Rows rows;
  std::vector<MappedPhotograph> mapped;
  size_t done = 0;
  for (Photograph& photograph : photographs) {
    const auto guess = frame->guess_of(a, photograph);
    PhotographPose placed;
    auto focal =
        a.lens.empty() ? Result<double>(photograph.focal_px.value_or(0)) : focal_of_lens(a.lens, photograph.bgr.size());
    if (!focal) return print_failure(focal.failure());
    if (!guess) {
      placed.why = "it does not say where it was taken (no GPS in EXIF): give --near LAT,LON";
    } else if (!(*focal > 0)) {
      placed.why = "it does not say its focal length (no 35 mm equivalent in EXIF): give --lens, as 26mm or 70deg";
    } else {
      if (mapped.empty()) print_ground(**localizer, *guess);
      const auto answer = (*localizer)->estimate_pose(photograph.bgr, *focal, *guess);
      if (!answer) return print_failure(answer.failure());
      placed = *answer;
      mapped.push_back({photograph.file.stem().string(), *guess, placed});
    }
    const auto ground = (*localizer)->ground(placed.p_n.head<2>());
    rows.push_back(row_of(photograph, *frame, placed, ground ? ground->down_m - placed.p_n.z() : 0));
    if (!a.json) std::printf("%s\n", line_of(rows.back()).c_str()), std::fflush(stdout);
    if (placed.placed) {
      ++done;
      const fs::path drawn = fs::path(a.output) / (photograph.file.stem().string() + "_roofs.jpg");
      if (!cv::imwrite(drawn.string(), roofs_over(photograph.bgr, *focal, placed, **localizer)))
        return print_failure({ODO_E_ERROR, drawn.string() + ": cannot be written"});
    }
    photograph.bgr.release();
  }
  const fs::path table = fs::path(a.output) / "photographs.csv", map = fs::path(a.output) / "map.png";
  if (const auto written = write_csv(table, rows, frame->in_model()); !written) return print_failure(written.failure());
  if (!mapped.empty() && !cv::imwrite(map.string(), map_of(mapped, **localizer)))
    return print_failure({ODO_E_ERROR, map.string() + ": cannot be written"});
  if (a.json)
    std::printf("%s\n", Json(rows).dump(2).c_str());
  else
    std::printf("%zu of %zu placed; %s, %s and the roofs drawn over the placed ones are in %s\n", done, rows.size(),
                table.filename().c_str(), map.filename().c_str(), a.output.c_str());
  return status != kDone ? status : done > 0 ? kDone : kLostTracking;
}

}  // namespace

void add_city_locate(CLI::App& city, int& status) {
  auto a = std::make_shared<LocateArguments>();
  auto* command = city.add_subcommand("locate", "Locate photographs in a city model by their skyline");
  command->add_option("pictures", a->pictures, "photographs, or folders of them (jpg, png)")->required();
  command->add_option("--model", a->model, "city model: CityJSON or CityGML")->required()->check(CLI::ExistingFile);
  auto* near = command->add_option(
      "--near", a->near, "LAT,LON in degrees: where the photographs were taken, instead of their EXIF position");
  command->add_option("--at", a->at, "the same as easting and northing in the model's coordinates, m")
      ->expected(2)
      ->excludes(near);
  command->add_option("--model-at", a->model_at,
                      "LAT,LON of the model's origin, in degrees, if its reference system is unknown");
  command->add_option("--sigma", a->sigma_m, "standard deviation of the position, m; default: EXIF's, or 10")
      ->check(CLI::Range(0.5, 100.0));
  command->add_option("--heading", a->heading_deg,
                      "viewing direction, degrees clockwise from north, instead of EXIF's");
  command->add_option("--heading-sigma", a->heading_sigma_deg, "standard deviation of the heading, degrees")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 60.0));
  command->add_flag("--any-heading", a->any_heading, "try all headings, whatever EXIF states");
  command->add_option(
      "--lens", a->lens,
      "focal length as 26mm (35 mm equivalent) or 1500px, angle of view of the long side as 70deg, or a camera.yaml");
  command
      ->add_option("-o,--output", a->output,
                   "folder for the table, the map and the photographs with the roofs drawn over them")
      ->capture_default_str();
  command->add_flag("--json", a->json, "print the table as JSON");
  command->callback([a, &status] { status = locate(*a); });
}

}  // namespace odograph
