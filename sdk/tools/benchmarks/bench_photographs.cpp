// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_photographs.hpp"

#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/city/photograph_localizer.hpp"
#include "sdk/tools/city/photograph_scene.hpp"
#include "sdk/tools/replay/recording_cache.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kThreeSigma2 = 11.829;  // chi-square of two degrees of freedom, 99.73 %
constexpr size_t kOfAWorld = 10;         // photographs under one sun
constexpr double kGood_m = 3, kGood_deg = 3;

/// A picture, from the cache or rendered: name and truth.
struct Taken {
  cv::Mat bgr;
  double focal_px;
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
};
Result<Taken> photograph_of(PhotographScene& scene, const fs::path& file, uint64_t number) {
  if (!fs::exists(file)) {
    const auto photograph = scene.take(number);
    if (!photograph) return photograph.failure();
    std::ofstream truth(file.string() + ".txt");
    const Eigen::Quaterniond& q = photograph->q_n_c;
    truth.precision(12);
    truth << "# focal_px north_m east_m down_m q_n_c_w q_n_c_x q_n_c_y q_n_c_z\n"
          << photograph->focal_px << ' ' << photograph->p_n.transpose() << ' ' << q.w() << ' ' << q.x() << ' ' << q.y()
          << ' ' << q.z() << '\n';
    if (!truth.flush() || !cv::imwrite(file.string(), photograph->bgr, {cv::IMWRITE_JPEG_QUALITY, 80}))
      return Failure{ODO_E_ERROR, file.string() + ": cannot be written"};
  }
  Taken t{cv::imread(file.string()), 0, {}, {}};
  std::ifstream truth(file.string() + ".txt");
  std::string header;
  if (truth.peek() == '#') std::getline(truth, header);
  truth >> t.focal_px >> t.p_n.x() >> t.p_n.y() >> t.p_n.z() >> t.q_n_c.w() >> t.q_n_c.x() >> t.q_n_c.y() >>
      t.q_n_c.z();
  if (!truth || t.bgr.empty()) return Failure{ODO_E_DATA, file.string() + ": cannot be read"};
  return t;
}

/// Results of a case.
struct Tally {
  std::vector<double> m, deg;
  size_t placed = 0, good = 0, beyond = 0, beyond_heading = 0, wrong = 0;
  Json lines = Json::array();
};

PhotographGuess guess_of(const PhotographBench& bench, const Taken& taken, double heading, uint64_t seed) {
  Random random(seed, 304);
  PhotographGuess guess{.north_m = taken.p_n.x() + bench.sigma_m * random.normal(),
                        .east_m = taken.p_n.y() + bench.sigma_m * random.normal(),
                        .sigma_m = bench.sigma_m,
                        .heading_sigma_rad = bench.heading_sigma_deg / kDeg_per_rad};
  const double off = bench.heading_sigma_deg / kDeg_per_rad * random.normal();
  if (bench.heading_sigma_deg < 180) guess.heading_rad = heading + off;
  const double aside = 2 * EIGEN_PI * random.uniform();
  guess.north_m += bench.prior_off_m * std::cos(aside), guess.east_m += bench.prior_off_m * std::sin(aside);
  return guess;
}

/// The command that locates the same photograph with the same prior.
std::string command_of(const PhotographBench& bench, const fs::path& file, const fs::path& model,
                       const Eigen::Vector3d& origin, double focal_px, const PhotographGuess& guess) {
  std::string command =
      text("odograph city locate %s --model %s --at %.2f %.2f --sigma %g --lens %.2fpx", file.c_str(), model.c_str(),
           origin.x() + guess.east_m, origin.y() + guess.north_m, bench.sigma_m, focal_px);
  if (guess.heading_rad)
    command += text(" --heading %.1f --heading-sigma %g", *guess.heading_rad * kDeg_per_rad, bench.heading_sigma_deg);
  return command;
}

Result<bool> add_to_tally(const PhotographBench& bench, const Taken& taken, const fs::path& file, const fs::path& model,
                          const Eigen::Vector3d& origin, uint64_t seed, PhotographLocalizer& localizer, Tally& to) {
  const Eigen::Vector3d axis = taken.q_n_c * Eigen::Vector3d::UnitZ();
  const double heading = std::atan2(axis.y(), axis.x());
  const PhotographGuess guess = guess_of(bench, taken, heading, seed);
  const auto answer = localizer.estimate_pose(taken.bgr, taken.focal_px, guess);
  if (!answer) return answer.failure();
  const double off_m = std::hypot(guess.north_m - taken.p_n.x(), guess.east_m - taken.p_n.y());
  const std::string line = file.filename().string() + text(": prior off %.1f m", off_m);
  const std::string command = "\n  " + command_of(bench, file, model, origin, taken.focal_px, guess);
  if (!answer->placed) {
    to.lines.push_back(line + ", not placed: " + answer->why + command);
    return true;
  }
  const Eigen::Vector2d d = (answer->p_n - taken.p_n).head<2>();
  const double turned_deg = std::abs(std::remainder(answer->heading_rad() - heading, 2 * EIGEN_PI)) * kDeg_per_rad;
  const double nees = d.dot(answer->covariance.inverse() * d);
  to.m.push_back(d.norm()), to.deg.push_back(turned_deg);
  ++to.placed;
  to.good += d.norm() <= kGood_m && turned_deg <= kGood_deg;
  to.wrong += d.norm() > 2 * kGood_m;
  to.beyond += nees > kThreeSigma2;
  to.beyond_heading += turned_deg > 3 * answer->heading_sigma_rad * kDeg_per_rad;
  to.lines.push_back(line +
                     text(", %.2f m (%.2f sigma of %.2f m), %.2f deg (sigma %.2f), agreement %.2f, risk %.3f", d.norm(),
                          std::sqrt(nees), answer->sigma_m(), turned_deg, answer->heading_sigma_rad * kDeg_per_rad,
                          answer->agreement, answer->integrity) +
                     command);
  return true;
}

Json row_of_tally(const Tally& t, size_t photographs) {
  const Format mostly{.parts = {0.5, 0.95}};
  Json row = row_of({{"photographs", "", "photographs", 0, photographs, kSum},
                     {"", "", "placed", -1, t.placed, kSum},
                     {"placed", "%", "placed_percent", 1, {t.placed, photographs}, kShare},
                     {"", "", "within_3_m_3_deg", -1, t.good, kSum},
                     {"in 3 m", "and 3 deg %", "within_3_m_3_deg_percent", 1, {t.good, photographs}, kShare},
                     {"place", "m", "_place_m", 2, t.m, mostly},
                     {"heading", "deg", "_heading_deg", 2, t.deg, mostly},
                     {"over 6 m", "off", "wrong", 0, t.wrong, kSum},
                     {"> 3 sigma", "place", "beyond_3_sigma", 0, t.beyond, kSum},
                     {"> 3 sigma", "heading", "heading_beyond_3_sigma", 0, t.beyond_heading, kSum}});
  row["lines"] = t.lines;
  return row;
}

}  // namespace

void PhotographBench::add_options(CLI::App& command) {
  command
      .add_option("--photographs", count,
                  "single photographs instead of drives, this number in each model (CityJSON); default of --roofs 1.5 "
                  "m, of --missing 0.1")
      ->check(CLI::Range(1, 10000))
      ->group(kCases);
  command
      .add_option("--heading-sigma", heading_sigma_deg,
                  "of a photograph's compass, degrees, up to 60; 180: there is none")
      ->check(CLI::Range(0.5, 60.0) | CLI::Range(180.0, 180.0));
  command.add_option(
      "--prior-off", prior_off_m,
      "displacement of a photograph's known position in any direction, m: beyond the search, where every "
      "position found is wrong");
  command.add_flag("--each", each, "a line for each photograph, and the command that locates it")->group(kOutput);
}

Result<std::vector<BenchCase>> PhotographBench::cases(const std::vector<std::string>& models,
                                                      const BenchOptions& options) const {
  const auto plugins =
      read_pipeline_config("odograph: 1\nabsolute_fixers:\n  - plugin: fix/skyline\n", "fix/skyline", {});
  if (!plugins) return plugins.failure();
  std::error_code error;
  fs::create_directories(options.keep, error);
  std::vector<BenchCase> all;
  for (const std::string& model : models)
    for (size_t k = 0; k < count; k += kOfAWorld)
      all.push_back(
          {{{"city", fs::path(model).stem().stem().string()}, {"first", k}, {"of_it", std::min(kOfAWorld, count - k)}},
           {fs::absolute(model), plugins->fixers.at(0).manifest.library},
           {},
           options.first_seed + k / kOfAWorld});
  return all;
}

Result<Json> PhotographBench::measure(const BenchCase& one, const BenchOptions& options) const {
  const fs::path model = one.files.front();
  const auto city = read_city_model(model);
  if (!city) return city.failure();
  const auto content = text_of(model);
  if (!content) return content.failure();
  const std::string place = one.labels["city"].get<std::string>() + '-' + simulator_mark(*content);
  const fs::path thinned = fs::path(options.keep) / text("%s_without_%g_%llu.city.json", place.c_str(), errors.missing,
                                                         static_cast<unsigned long long>(one.seed));
  const auto written = write_model_with_errors(model, thinned, {.missing = errors.missing, .seed = one.seed});
  if (!written) return written.failure();
  auto localizer = PhotographLocalizer::make(thinned, {.model = city->origin});
  if (!localizer) return localizer.failure();
  PhotographSceneParameters p;
  p.roof_sigma_m = errors.roof_sigma_m;
  PhotographScene scene(*city, one.seed, p);
  Tally tally;
  const auto of_it = one.labels["of_it"].get<size_t>();
  for (size_t k = 0; k < of_it; ++k) {
    const fs::path file =
        fs::path(options.keep) / text("photograph_%s_%g_%llu_%zu.jpg", place.c_str(), errors.roof_sigma_m,
                                      static_cast<unsigned long long>(one.seed), k);
    const auto photograph = photograph_of(scene, file, k);
    if (!photograph) return photograph.failure();
    const auto done =
        add_to_tally(*this, *photograph, file, thinned, city->origin, one.seed * 1000 + k, **localizer, tally);
    if (!done) return done.failure();
    if (one.run.progress) one.run.progress(k + 1, of_it);
  }
  return row_of_tally(tally, of_it);
}

BenchReport PhotographBench::report(const Rows& rows) const {
  Table table{"", {{"city", "city"}}, columns_of(rows)};
  const Rows lines = summaries_of(rows, "city", table.columns);
  std::string said = table_text(table, lines);
  if (each)
    for (const Json& row : rows)
      for (const Json& line : row["lines"]) said += line.get<std::string>() + '\n';
  return {said, visible_rows(lines)};
}

}  // namespace odograph
