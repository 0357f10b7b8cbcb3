// SPDX-License-Identifier: Apache-2.0
//
// `odograph map`: what is in files of maps; one of several, smaller ones, points.
#include <cstdio>
#include <iomanip>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/replay/map_file.hpp"
#include "sdk/tools/replay/ply.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

struct MapArguments {
  std::vector<std::string> files, plugins;
  std::string output;
  double size_mb = 0;
  bool json = false;
};

Result<MapFile> read(const std::string& file, const MapArguments& a) {
  return MapFile::read(file, {a.plugins.begin(), a.plugins.end()});
}

double megabytes(size_t bytes) { return 1e-6 * static_cast<double>(bytes); }

struct Contents {
  size_t bytes = 0, landmarks = 0;
  std::set<uint32_t> epochs;
  double path_m = 0;
  Vector3d extent_m = Vector3d::Zero();
};

Contents contents_of(const MapFile& map) {
  Contents c;
  c.bytes = map.bytes().size();
  Eigen::AlignedBox3d box;
  const MapFile::View* before = nullptr;
  for (const MapFile::View& view : map.views()) {
    c.landmarks += view.landmarks.size();
    c.epochs.insert(view.epoch);
    box.extend(view.p_m);
    if (before && before->epoch == view.epoch) c.path_m += (view.p_m - before->p_m).norm();
    before = &view;
  }
  if (!box.isEmpty()) c.extent_m = box.sizes();
  return c;
}

nlohmann::ordered_json json_of(const MapFile& map) {
  const Contents c = contents_of(map);
  const auto numbers = [](const Vector3d& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
  nlohmann::ordered_json anchors = nlohmann::ordered_json::array();
  for (const MapFile::Anchor& anchor : map.anchors())
    anchors.push_back({{"name", anchor.name}, {"p_m", numbers(anchor.p_m)}, {"sigma_m", anchor.sigma_m}});
  return {{"file", map.path()},        {"plugin", map.plugin()},           {"version", map.version()},
          {"bytes", c.bytes},          {"key_frames", map.views().size()}, {"landmarks", c.landmarks},
          {"epochs", c.epochs.size()}, {"extent_m", numbers(c.extent_m)},  {"path_m", c.path_m},
          {"anchors", anchors}};
}

void print(const MapFile& map) {
  const Contents c = contents_of(map);
  std::printf("%s: %s %s, %.2f MB\n", printable(map.path()).c_str(), map.plugin().c_str(), map.version().c_str(),
              megabytes(c.bytes));
  std::printf("  %zu key frames with %zu landmarks, tracked in %zu piece%s\n", map.views().size(), c.landmarks,
              c.epochs.size(), c.epochs.size() == 1 ? "" : "s");
  std::printf("  %.1f m from key frame to key frame, over %.1f x %.1f m and %.1f m of height\n", c.path_m,
              c.extent_m.x(), c.extent_m.y(), c.extent_m.z());
  for (const MapFile::Anchor& anchor : map.anchors())
    std::printf("  anchor %s at %.2f, %.2f, %.2f m (z down), +- %.2f m\n",
                anchor.name.empty() ? "without a name" : ("'" + printable(anchor.name) + "'").c_str(), anchor.p_m.x(),
                anchor.p_m.y(), anchor.p_m.z(), anchor.sigma_m);
}

int show(const MapArguments& a) {
  int status = kDone;
  nlohmann::ordered_json maps = nlohmann::ordered_json::array();
  for (const std::string& file : a.files) {
    const auto map = read(file, a);
    if (!map)
      status = std::max(status, print_failure(map.failure()));
    else if (a.json)
      maps.push_back(json_of(*map));
    else
      print(*map);
  }
  if (a.json)
    std::printf("%s\n", nlohmann::ordered_json{{"maps", maps}}
                            .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                            .c_str());
  return status;
}

int write(const MapFile& map, const MapArguments& a) {
  if (const auto written = map.write(a.output); !written) return print_failure(written.failure());
  std::printf("%zu key frames, %.2f MB, written to %s\n", map.views().size(), megabytes(map.bytes().size()),
              printable(a.output).c_str());
  return kDone;
}

/// The others may be in any order: one that touches the first only by way of another is joined after that.
int merge(const MapArguments& a) {
  std::vector<MapFile> left;
  for (const std::string& file : a.files) {
    auto map = read(file, a);
    if (!map) return print_failure(map.failure());
    left.push_back(std::move(*map));
  }
  MapFile whole = std::move(left.front());
  left.erase(left.begin());
  std::string refused;
  for (size_t i = 0, since = 0; !left.empty(); i = i < left.size() ? i : 0) {
    const auto joint = whole.join(left[i]);
    if (!joint && joint.failure().status != ODO_E_NOT_FOUND) return print_failure(joint.failure());
    if (!joint) {
      refused += (refused.empty() ? "" : "\n") + joint.failure().text;
      if (++since == left.size()) return print_failure({ODO_E_DATA, refused + "\nnothing is written"});
      ++i;
      continue;
    }
    std::printf("%s: found: %zu of the %zu key frames of both agree, within %.2f m\n",
                printable(left[i].path()).c_str(), joint->agreeing, joint->asked, joint->sigma_m);
    for (const std::string& name : joint->doubled)
      std::printf("  anchor '%s' is in both: that of the first is kept\n", printable(name).c_str());
    left.erase(left.begin() + static_cast<ptrdiff_t>(i)), since = 0, refused.clear();
  }
  return write(whole, a);
}

int thin(const MapArguments& a) {
  auto map = read(a.files.front(), a);
  if (!map) return print_failure(map.failure());
  const size_t before = map->views().size();
  if (const auto done = map->thin(static_cast<uint64_t>(1e6 * a.size_mb)); !done) return print_failure(done.failure());
  std::printf("%zu of %zu key frames are left out\n", before - map->views().size(), before);
  return write(*map, a);
}

/// Landmarks grey; key frames from blue, the first, to red, the last.
int export_points(const MapArguments& a) {
  const auto map = read(a.files.front(), a);
  if (!map) return print_failure(map.failure());
  const Contents c = contents_of(*map);
  std::ostringstream out;
  write_ply_head(out, "metres in the frame of the map, z down; landmarks grey, key frames from blue to red",
                 c.landmarks + map->views().size(),
                 {"float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"});
  out << std::setprecision(7);
  const auto put = [&](const Vector3d& p, int red, int green, int blue) {
    out << p.x() << ' ' << p.y() << ' ' << p.z() << ' ' << red << ' ' << green << ' ' << blue << '\n';
  };
  for (size_t i = 0; i < map->views().size(); ++i) {
    const MapFile::View& view = map->views()[i];
    const auto red = static_cast<int>(255 * i / std::max<size_t>(1, map->views().size() - 1));
    put(view.p_m, red, 0, 255 - red);
    for (const Vector3d& p : view.landmarks) put(p, 160, 160, 160);
  }
  if (const auto written = write_whole_file(a.output, out.str()); !written) return print_failure(written.failure());
  std::printf("%zu landmarks and %zu key frames, written to %s\n", c.landmarks, map->views().size(),
              printable(a.output).c_str());
  return kDone;
}

}  // namespace

void add_map(CLI::App& app, int& status) {
  auto* map = app.add_subcommand("map", "Maps of places: contents, one of several, smaller ones, points");
  map->require_subcommand(1);
  auto a = std::make_shared<MapArguments>();
  const auto add = [&](const char* name, const char* help, int (*run)(const MapArguments&)) {
    auto* command = map->add_subcommand(name, help);
    command->add_option("--plugins", a->plugins, "folder to look for plugins in first");
    command->callback([a, &status, run] { status = run(*a); });
    return command;
  };
  const char* written = "file to write; one that exists is replaced";
  auto* shown = add("show", "Print what is in maps: key frames, landmarks, extent, anchors", show);
  shown->add_option("map", a->files, "files of `odograph run --map` or odo_map_save")->required();
  shown->add_flag("--json", a->json, "print one JSON object");
  auto* merged = add("merge", "Make one map of several of one place, in the frame of the first", merge);
  merged->add_option("map", a->files, "maps of one place, by different sessions or phones")
      ->required()
      ->expected(2, -1);
  merged->add_option("-o,--output", a->output, written)->required();
  auto* thinned = add("thin", "Leave out key frames beside others until a map is small enough", thin);
  thinned->add_option("map", a->files, "file of a map")->required()->expected(1);
  thinned->add_option("--size", a->size_mb, "largest size of the file, MB")
      ->required()
      ->check(CLI::Range(0.001, 250.0));
  thinned->add_option("-o,--output", a->output, written)->required();
  auto* exported = add("export", "Write landmarks and key frames as coloured points (PLY)", export_points);
  exported->add_option("map", a->files, "file of a map")->required()->expected(1);
  exported->add_option("-o,--output", a->output, "PLY file to write; one that exists is replaced")->required();
}

}  // namespace odograph
