// SPDX-License-Identifier: Apache-2.0
//
// `odograph city locate`: places single photographs in a city model.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <opencv2/imgcodecs.hpp>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/city/georeferenced_city.hpp"
#include "sdk/tools/city/photograph.hpp"
#include "sdk/tools/city/photograph_drawing.hpp"
#include "sdk/tools/city/photograph_table.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/table/table.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kSigma_m = 10, kHeadingSigma_deg = 20;  // of a phone's GNSS and compass between houses
constexpr double kDeclination_deg = 10;  // sigma of the declination, unknown here; beyond 30 only near the poles
constexpr double kReach_m = 60;          // of fix/skyline's search, which otherwise covers three sigmas

struct LocateArguments {
  std::vector<std::string> pictures;
  std::string model, near, model_at, lens, output = "out/locate";
  std::vector<double> at;
  double sigma_m = 0, heading_deg = NAN, heading_sigma_deg = kHeadingSigma_deg;
  bool any_heading = false, json = false;
};

Result<std::optional<Coordinates>> place_of(const std::string& option, const std::string& words) {
  if (words.empty()) return std::optional<Coordinates>();
  Coordinates place{};
  char rest = 0;
  if (std::sscanf(words.c_str(), "%lf ,%lf %c", &place[0], &place[1], &rest) != 2 || std::abs(place[0]) > 90 ||
      std::abs(place[1]) > 180)
    return Failure{ODO_E_ARGUMENT,
                   option + " " + words + ": expected latitude,longitude in degrees, as 48.3035,14.2875"};
  return std::optional(place);
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
      if (ending == ".jpg" || ending == ".jpeg" || ending == ".png" || ending == ".heic") files.push_back(entry.path());
    }
    std::sort(files.begin() + before, files.end());
    if (static_cast<std::ptrdiff_t>(files.size()) == before)
      return Failure{ODO_E_NOT_FOUND, name + ": no pictures in it (jpg, png)"};
  }
  return files;
}

/// A picture file, with what it states or why it cannot be read.
struct Picture {
  fs::path file;
  Result<Photograph> stated;
};

/// The inputs that a photograph lacks, with the options that give them.
std::vector<std::string> missing_inputs(const LocateArguments& a, const Photograph& p) {
  std::vector<std::string> missing;
  if (a.near.empty() && a.at.empty() && !p.place_deg)
    missing.emplace_back("where it was taken (no GPS position in EXIF): give --near LAT,LON or --at EASTING NORTHING");
  if (a.lens.empty() && !p.focal_px)
    missing.emplace_back("its focal length (no 35 mm equivalent in EXIF): give --lens, as 26mm or 70deg");
  return missing;
}

/// Places the pictures one by one; each gets a row, of the table and of the output.
class Locator {
 public:
  /// `place`: of the command line; `count`: of pictures, for the progress.
  Locator(const LocateArguments& a, std::optional<Coordinates> place, GeoreferencedCity& city, size_t count)
      : a_(a),
        place_(place),
        city_(city),
        count_(count),
        csv_(fs::path(a.output) / "photographs.csv", city.is_geodetic()) {}

  Result<bool> add(const Picture& picture) {
    PhotographPose placed;
    cv::Mat bgr;
    std::optional<PhotographInputs> prior;
    if (!picture.stated) {
      placed.why = unreadable(picture, picture.stated.failure());
    } else if (const auto done = locate(picture, bgr, prior, placed); !done) {
      return done.failure();
    }
    const auto ground = city_.localizer().ground(placed.p_n.head<2>());
    Json row = row_of_photograph(picture.file, city_, prior, placed, ground ? ground->down_m - placed.p_n.z() : 0);
    if (placed.placed) {
      const std::string stem = picture.file.stem().string();
      std::string name = stem + "_roofs.jpg";
      for (int copy = 2; !drawings_.insert(name).second; ++copy)  // the same name in another folder
        name = stem + "_" + std::to_string(copy) + "_roofs.jpg";
      row["drawing"] = name;
      draw_roofs(bgr, prior->focal_px, placed, city_.localizer());
      if (const auto written = write(name, bgr); !written) return written;
    }
    rows_.push_back(row);
    if (!a_.json) std::printf("%s\n", text_of_photograph(row).c_str()), std::fflush(stdout);
    return csv_.add(row);
  }

  int finish() const {
    const auto done = std::count_if(rows_.begin(), rows_.end(), [](const Json& row) { return row["placed"] == true; });
    if (a_.json)
      std::printf("%s\n", Json(rows_).dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    else
      std::printf("%zu of %zu placed; %s has photographs.csv%s%s\n", static_cast<size_t>(done), rows_.size(),
                  a_.output.c_str(), mapped_.empty() ? "" : ", map.png",
                  done > 0 ? " and the photographs with the roofs drawn over them" : "");
    return bad_data_ ? kBadData : done > 0 ? kDone : kLostTracking;
  }

 private:
  std::string unreadable(const Picture& picture, const Failure& failure) {
    bad_data_ = true;
    const std::string name = picture.file.string() + ": ";
    return failure.text.starts_with(name) ? failure.text.substr(name.size()) : failure.text;
  }
  Result<bool> write(const std::string& name, const cv::Mat& bgr) const {
    const fs::path file = fs::path(a_.output) / name;
    return cv::imwrite(file.string(), bgr) ? Result<bool>(true)
                                           : Failure{ODO_E_IO, file.string() + ": cannot be written"};
  }

  Result<bool> locate(const Picture& picture, cv::Mat& bgr, std::optional<PhotographInputs>& prior,
                      PhotographPose& placed) {
    const Photograph& photograph = *picture.stated;
    for (const std::string& what : missing_inputs(a_, photograph))
      placed.why += (placed.why.empty() ? "it does not state " : "; nor ") + what;
    if (!placed.why.empty()) return true;
    const Coordinates place = place_ ? *place_ : *photograph.place_deg;
    if (const auto why = city_.why_not_at(place)) {
      placed.why = *why;
      return true;
    }
    auto pixels = read_pixels(photograph);
    if (!pixels) {
      placed.why = unreadable(picture, pixels.failure());
      return true;
    }
    bgr = std::move(*pixels);
    const auto focal = a_.lens.empty() ? Result<double>(*photograph.focal_px) : focal_of_lens(a_.lens, bgr.size());
    if (!focal) return focal.failure();
    prior = PhotographInputs{guess_of(photograph, place), *focal};
    print_notes(picture, prior->guess);
    {
      Progress progress(picture.file.filename().string() + text(", %zu of %zu", rows_.size() + 1, count_));
      progress.show(rows_.size(), count_);
      const auto answer = city_.localizer().estimate_pose(bgr, *focal, prior->guess);
      if (!answer) {
        placed.why = unreadable(picture, answer.failure());
        return true;
      }
      placed = *answer;
    }
    mapped_.push_back({picture.file.stem().string(), prior->guess, placed});
    return write("map.png", map_of(mapped_, city_.localizer()));
  }

  /// The prior of a photograph: from the command line, otherwise from its EXIF data.
  PhotographGuess guess_of(const Photograph& p, const Coordinates& place) const {
    PhotographGuess guess;
    const Eigen::Vector3d at = city_.p_n(place);
    guess.north_m = at.x(), guess.east_m = at.y();
    guess.sigma_m = a_.sigma_m > 0 ? a_.sigma_m : place_ ? kSigma_m : p.place_sigma_m.value_or(kSigma_m);
    const double heading = std::isfinite(a_.heading_deg) ? a_.heading_deg : p.heading_deg.value_or(NAN);
    if (std::isfinite(heading) && !a_.any_heading) guess.heading_rad = std::remainder(heading, 360) * kRad_per_deg;
    const bool magnetic = !std::isfinite(a_.heading_deg) && p.heading_is_magnetic;
    guess.heading_sigma_rad = std::hypot(a_.heading_sigma_deg, magnetic ? kDeclination_deg : 0) * kRad_per_deg;
    return guess;
  }

  /// Reports what the search cannot cover, and, for the first photograph, a model without terrain.
  void print_notes(const Picture& picture, const PhotographGuess& guess) const {
    if (3 * guess.sigma_m > kReach_m)
      std::fprintf(stderr, "odograph: %s: its position has a sigma of %.0f m; the search ends at %.0f m from it\n",
                   picture.file.c_str(), guess.sigma_m, kReach_m);
    const auto ground = city_.localizer().ground({guess.north_m, guess.east_m});
    if (mapped_.empty() && ground && !ground->terrain)
      std::fprintf(stderr,
                   "odograph: the model has no terrain there: its ground is taken from the lowest corners of the "
                   "buildings around, %.1f m high at the place that was given\n",
                   -ground->down_m);
  }

  const LocateArguments& a_;
  std::optional<Coordinates> place_;
  GeoreferencedCity& city_;
  size_t count_;
  PhotographCsv csv_;
  Rows rows_;
  std::vector<MappedPhotograph> mapped_;
  std::set<std::string> drawings_;
  bool bad_data_ = false;
};

Result<GeoreferencedCity> open_city(const LocateArguments& a, std::optional<Coordinates> place,
                                    std::optional<Coordinates> zero_deg, const std::vector<Picture>& pictures) {
  if (!a.at.empty()) return GeoreferencedCity::own(a.model, place);
  if (zero_deg) return GeoreferencedCity::with_zero_at(a.model, *zero_deg);
  for (const Picture& picture : pictures)
    if (!place && picture.stated) place = picture.stated->place_deg;
  auto city = GeoreferencedCity::geodetic(a.model, place);
  if (city || city.failure().status != ODO_E_UNSUPPORTED) return city;
  return Failure{ODO_E_UNSUPPORTED, city.failure().text +
                                        ": give the place in its own coordinates by --at EASTING NORTHING, or, where "
                                        "the model lies around its zero, --model-at LAT,LON of that"};
}

int locate(const LocateArguments& a) {
  auto place = place_of("--near", a.near);
  const auto zero_deg = place_of("--model-at", a.model_at);
  if (!place || !zero_deg) return print_failure(place ? zero_deg.failure() : place.failure());
  if (!a.at.empty()) *place = Coordinates{a.at[0], a.at[1]};
  if (const auto focal = focal_of_lens(a.lens, {4000, 3000}); !a.lens.empty() && !focal)
    return print_failure(focal.failure());
  const auto files = files_of(a.pictures);
  if (!files) return print_failure(files.failure());
  std::vector<Picture> pictures;
  std::vector<std::vector<std::string>> missing;  // inputs, of each readable picture
  for (const fs::path& file : *files) {
    pictures.push_back({file, read_photograph(file)});
    if (pictures.back().stated) missing.push_back(missing_inputs(a, *pictures.back().stated));
  }
  int status = kDone;
  if (missing.empty()) {
    for (const Picture& picture : pictures) status = print_failure(picture.stated.failure());
    return status;
  }
  std::error_code error;
  fs::create_directories(a.output, error);
  if (error) return print_failure({ODO_E_IO, a.output + ": no folder can be made there: " + error.message()});
  auto city = open_city(a, *place, *zero_deg, pictures);
  // Everything that is missing is reported at once.
  for (const std::string& what : missing.front())
    if (std::all_of(missing.begin(), missing.end(),
                    [&](const auto& of_one) { return std::count(of_one.begin(), of_one.end(), what) > 0; }))
      status = print_failure({ODO_E_ARGUMENT, "no picture states " + what});
  if (!city) status = print_failure(city.failure());
  if (status != kDone) return status;
  if (const std::string& system = city->reference_system(); !system.empty())
    std::fprintf(stderr, "odograph: %s\n", system.c_str());
  Locator locator(a, *place, *city, pictures.size());
  for (const Picture& picture : pictures)
    if (const auto done = locator.add(picture); !done) {
      locator.finish();
      return print_failure(done.failure());
    }
  return locator.finish();
}

}  // namespace

void add_city_locate(CLI::App& city, int& status) {
  auto a = std::make_shared<LocateArguments>();
  auto* command = city.add_subcommand("locate", "Locate photographs in a city model by their skyline");
  command
      ->add_option("pictures", a->pictures,
                   "photographs, or folders of them without their subfolders (jpg, png; HEIC: convert it first)")
      ->required();
  command->add_option("--model", a->model, "city model: CityJSON or CityGML")->required()->check(CLI::ExistingFile);
  auto* near = command->add_option(
      "--near", a->near,
      "LAT,LON in degrees: where the photographs were taken, instead of EXIF's position and its sigma");
  auto* at = command->add_option("--at", a->at, "the same as easting and northing in the model's coordinates, m")
                 ->expected(2)
                 ->excludes(near);
  command
      ->add_option("--model-at", a->model_at,
                   "LAT,LON in degrees of the zero of a model without a reference system, some km away at most")
      ->excludes(at);
  command
      ->add_option(
          "--sigma", a->sigma_m,
          "standard deviation of north and of east, m; default: EXIF's, or 10; the search covers three, at most 60 m")
      ->check(CLI::Range(0.5, 100.0));
  command->add_option("--heading", a->heading_deg, "viewing direction, degrees clockwise from north, instead of EXIF's")
      ->check(CLI::Range(-360.0, 360.0));
  command->add_option("--heading-sigma", a->heading_sigma_deg, "standard deviation of the heading, degrees")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 60.0));
  command->add_flag("--any-heading", a->any_heading, "try all headings, whatever EXIF states");
  command->add_option(
      "--lens", a->lens,
      "focal length as 26mm (35 mm equivalent, by the diagonal) or 1500px, angle of view of the long side as 70deg, or "
      "a camera.yaml");
  command
      ->add_option("-o,--output", a->output,
                   "folder for the table, the map and the photographs with the roofs drawn over them")
      ->capture_default_str();
  command->add_flag("--json", a->json, "print the table as JSON");
  command->footer(
      "Exit status: 3 a picture or the model cannot be read, 2 bad usage or a missing input, otherwise 0 where a "
      "photograph was placed and 1 where none was.");
  command->callback([a, &status] { status = locate(*a); });
}

}  // namespace odograph
