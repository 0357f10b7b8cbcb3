// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/pipeline_config.hpp"

#include <algorithm>
#include <optional>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/platform/features.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {
namespace {

const YamlNode* in_plugins(const YamlNode& root, const char* key) {
  const YamlNode* plugins = root.find("plugins");
  return plugins ? plugins->find(key) : nullptr;
}

/// Reads the search path and the allow list before the whole file is validated, because the validation needs them.
/// Mistakes in them are reported by that validation.
std::vector<std::string> raw_texts(const YamlNode& root, const char* key) {
  std::vector<std::string> texts;
  if (const YamlNode* list = in_plugins(root, key))
    for (const YamlNode& item : list->items) texts.push_back(item.text);
  return texts;
}

std::vector<Signer> raw_signers(const YamlNode& root) {
  std::vector<Signer> signers;
  const YamlNode* list = in_plugins(root, "signers");
  for (size_t i = 0; list && i < list->items.size(); ++i) {
    const YamlNode* ids = list->items[i].find("ids");
    const YamlNode* key = list->items[i].find("key");
    signers.push_back({ids ? ids->text : "*", key ? key->text : ""});
  }
  return signers;
}

std::string raw_text(const YamlNode& root, const char* key) {
  const YamlNode* node = in_plugins(root, key);
  return node ? node->text : "";
}

/// A parameter named walker_height defaults to the walker's height. So does `height` of fix/terrain, which has another
/// name since 1.0; a vendor's `height` may be any height.
void share_walker(PluginChoice& choice, const Value& walker) {
  if (!walker["height"].given) return;
  for (auto& [spec, value] : choice.parameters) {
    const bool of_walker =
        spec.name == "walker_height" || (spec.name == "height" && choice.manifest.id == "fix/terrain");
    if (of_walker && spec.type == SpecType::real && !value.given) value.real = walker["height"].real;
  }
}

Isolation isolation_of(const Value& plugin, const Value& plugins, const std::filesystem::path& program) {
  Isolation isolation;
  const Value& own = plugin["isolation"];
  const std::string& kind = (own.given ? own : plugins["isolation"]).text;
  if (kind == "process") isolation.kind = Isolation::Kind::process;
  isolation.time_s = plugin["time_limit"].real;
  isolation.start_s = plugin["start_limit"].real;
  isolation.memory_bytes = static_cast<uint64_t>(plugin["memory_limit"].integer) << 20;
  isolation.program = program;
  return isolation;
}

/// Search path of plugins and rules for which may be loaded.
struct PluginPolicy {
  std::vector<std::string> allow;
  std::vector<Signer> signers;
  std::vector<std::filesystem::path> folders;  // of relative names
  std::filesystem::path program;               // odograph-plugin-host

  /// A library that is allowed by its hash must have that hash; a signed manifest binds its library by hash.
  LibraryCheck library_check(bool verify_hash) const {
    if (std::any_of(allow.begin(), allow.end(), is_sha256) || !signers.empty()) return LibraryCheck::sealed;
    return verify_hash ? LibraryCheck::hash : LibraryCheck::none;
  }
};

Result<Value> checked_values(const YamlNode& root, const std::string& name, PluginRegistry& registry,
                             const PluginPolicy& policy) {
  const PluginResolver resolver = [&](const std::string& id,
                                      const std::string& kind) -> Result<const std::vector<Spec>*> {
    auto manifest = registry.find(id, kind, policy.folders, policy.allow);
    if (!manifest) return manifest.failure();
    return &(*manifest)->parameters;
  };
  auto checked = validate(root, pipeline_spec(), name, resolver);
  if (!checked) return checked.failure();
  for (const char* key : {"allow", "signers"})  // an empty list would allow everything
    if (const YamlNode* list = in_plugins(root, key); list && list->items.empty())
      return Failure{ODO_E_CONFIG, at(name, list->mark,
                                      std::string("plugins.") + key +
                                          ": an empty list; expected one item or more, or no '" + key + "' at all")};
  for (const Value& signer :
       (*checked)["plugins"]["signers"].items)  // a pattern that matches nothing would exempt every plugin
    if (const std::string& ids = signer["ids"].text; ids.find('*') < ids.size() - 1 || ids.empty())
      return Failure{ODO_E_CONFIG, at(name, signer["ids"].mark,
                                      "plugins.signers: '" + ids + "'; expected an id, with '*' only at its end")};
  return checked;
}

void read_navigation(const Value& navigation, PipelineConfig& config) {
  const Value& origin = navigation["origin"];
  if (origin.given) config.origin = {origin["latitude"].real, origin["longitude"].real, origin["height"].real};
  if (navigation["declination"].given) config.declination_rad = navigation["declination"].real;
  const Value& start = navigation["start"];
  if (!start.given) return;
  const auto& p = start["position"].reals;
  config.start = {{p[0], p[1], p[2]}, start["heading"].real, true, start["heading"].given};
}

CouplingConfig coupling_of(const Value& coupling) {
  CouplingConfig config;
  config.type = coupling["type"].text == "localizer" ? CouplingType::localizer : CouplingType::paper;
  const std::string& orientation = coupling["orientation"].text;
  config.orientation = orientation == "attitude"    ? Orientation::attitude
                       : orientation == "gyroscope" ? Orientation::gyroscope
                                                    : Orientation::vo;
  config.vertical = coupling["vertical"].text == "scaled" ? Vertical::scaled : Vertical::ignore;
  config.compass = coupling["compass"].text == "start" ? Compass::start : Compass::always;
  config.fix_gate_sigma = coupling["fix_gate"].real;
  config.bridge_s = coupling["bridge"].real;
  config.fastest_mps = coupling["fastest"].real;
  config.odometry_covariance = coupling["odometry_covariance"].real;
  return config;
}

/// One plugin of the config; its fallback has default parameters.
PluginChoice choose(const Value& value, const Spec& spec, const Value& v, PluginRegistry& registry,
                    const PluginPolicy& policy, const std::string& file) {
  PluginChoice choice;
  choice.place = at(file, value.mark, "");
  choice.manifest = **registry.find(value["plugin"].text, spec.interface_id, policy.folders, policy.allow);
  choice.interface_id = spec.interface_id;
  for (const Spec& parameter : choice.manifest.parameters)
    choice.parameters.emplace_back(parameter, value["parameters"][parameter.name]);
  share_walker(choice, v["walker"]);
  choice.isolation = isolation_of(value, v["plugins"], policy.program);
  if (!value["fallback"].given) return choice;
  auto fallback = std::make_shared<PluginChoice>();
  fallback->manifest = **registry.find(value["fallback"].text, spec.interface_id, policy.folders, policy.allow);
  fallback->interface_id = spec.interface_id;
  fallback->place = at(file, value["fallback"].mark, "");
  for (const Spec& parameter : fallback->manifest.parameters)
    fallback->parameters.emplace_back(parameter, default_value(parameter));
  share_walker(*fallback, v["walker"]);
  fallback->isolation = choice.isolation;
  choice.fallback = std::move(fallback);
  return choice;
}

/// A linked-in plugin runs in the app's process, as do all plugins on a platform without processes.
std::optional<Failure> check_isolation(const PluginChoice& choice, Mark mark, const std::string& name) {
  for (const PluginChoice* each = &choice; each; each = each->fallback.get()) {
    if (each->isolation.kind != Isolation::Kind::process || (kPlatform.processes && !each->manifest.entry)) continue;
    std::string why = each->manifest.entry ? "is linked into the app and cannot" : "cannot";
    why += " run in a process of its own";
    if (!kPlatform.processes) why += std::string(", which this program's platform (") + kPlatform.name + ") has not";
    return Failure{
        ODO_E_CONFIG,
        at(name, mark, "isolation: plugin '" + each->manifest.id + "' " + why + "; expected 'isolation: none'")};
  }
  return std::nullopt;
}

std::optional<Failure> choose_plugins(const Value& v, PluginRegistry& registry, const PluginPolicy& policy,
                                      PipelineConfig& config) {
  for (const Spec& spec : pipeline_spec().children) {
    const Value& value = v[spec.name];
    if (spec.type != SpecType::plugins || !value.given) continue;
    auto& kind = spec.name == "attitude"         ? config.attitudes
                 : spec.name == "step_estimator" ? config.step_estimators
                 : spec.name == "vo_frontend"    ? config.vo_frontends
                 : spec.name == "scale_source"   ? config.scale_sources
                 : spec.name == "surface_finder" ? config.surface_finders
                                                 : config.fixers;
    for (const Value& item : value.items) {
      kind.push_back(choose(item, spec, v, registry, policy, config.name));
      if (const auto wrong = check_isolation(kind.back(), item.mark, config.name)) return wrong;
    }
  }
  return std::nullopt;
}

/// Checks that the plugins are present whose output other plugins need.
std::optional<Failure> check_companions(const PipelineConfig& config, const Value& v) {
  if (!config.step_estimators.empty() && config.attitudes.empty())
    return Failure{
        ODO_E_CONFIG,
        at(config.name, v["step_estimator"].mark,
           "step_estimator: needs orientation; expected an 'attitude' plugin beside it (nearest: 'attitude')")};
  if (!config.scale_sources.empty() && config.vo_frontends.empty())
    return Failure{
        ODO_E_CONFIG,
        at(config.name, v["scale_source"].mark,
           "scale_source: nothing to scale; expected a 'vo_frontend' plugin beside it (nearest: 'vo_frontend')")};
  if (!config.surface_finders.empty() && config.vo_frontends.empty())
    return Failure{
        ODO_E_CONFIG,
        at(config.name, v["surface_finder"].mark,
           "surface_finder: no landmarks; expected a 'vo_frontend' plugin beside it (nearest: 'vo_frontend')")};
  return std::nullopt;
}

Result<PipelineConfig> interpret(const YamlNode& root, const std::string& text, const std::string& name,
                                 const std::vector<std::filesystem::path>& folders,
                                 std::vector<std::filesystem::path> directories) {
  if (root.kind == YamlNode::Kind::null)
    return Failure{ODO_E_CONFIG, at(name, {}, "the config is empty; expected a map that starts with 'odograph: 1'")};
  PluginPolicy policy{raw_texts(root, "allow"), raw_signers(root), folders, {}};
  for (const auto& named : raw_texts(root, "search")) {
    const auto directory = find_named(named, folders);
    if (!directory && folders.empty())
      return Failure{ODO_E_CONFIG,
                     at(name, in_plugins(root, "search")->mark, "plugins.search: " + directory.failure().text)};
    directories.push_back(directory ? *directory : folders.front() / utf8_path(named));
  }
  PluginRegistry registry(plugin_directories(directories), directories.size());
  registry.require_signature(policy.signers);
  registry.allow_writable(raw_text(root, "allow_writable") == "true");
  const auto checked = checked_values(root, name, registry, policy);
  if (!checked) return checked.failure();
  const Value& v = *checked;

  PipelineConfig config;
  config.name = name;
  config.text = text;
  config.library_check = policy.library_check(v["plugins"]["verify_hash"].boolean);
  read_navigation(v["navigation"], config);
  if (v["camera"].given) {
    const auto path = find_named(v["camera"].text, folders);
    if (!path) return Failure{ODO_E_CONFIG, at(name, v["camera"].mark, "camera: " + path.failure().text)};
    const auto camera = read_camera_yaml(*path, nullptr);
    if (!camera) return Failure{ODO_E_CONFIG, at(name, v["camera"].mark, "camera: " + camera.failure().text)};
    config.camera = *camera;
  }
  const Value& ordering = v["time_ordering"];
  config.ordering = {ordering["max_wait"].real, ordering["max_gap"].real,
                     static_cast<size_t>(ordering["queue"].integer), static_cast<size_t>(ordering["frames"].integer)};
  config.coupling = coupling_of(v["coupling"]);
  if (const Value& host = v["plugins"]["host"]; host.given) {
    const auto program = find_named(host.text, folders);
    if (!program) return Failure{ODO_E_CONFIG, at(name, host.mark, "plugins.host: " + program.failure().text)};
    policy.program = *program;
  }
  config.replay = {v["replay"]["start_at_first_waypoint"].boolean, v["replay"]["align_heading_over"].real};
  if (const auto wrong = choose_plugins(v, registry, policy, config)) return *wrong;
  if (const auto missing = check_companions(config, v)) return *missing;
  if (v["walker"]["height"].given || !config.step_estimators.empty())
    config.walker_height_m = v["walker"]["height"].real;
  return config;
}

}  // namespace

Result<PipelineConfig> read_pipeline_config(const std::string& text, const std::string& name,
                                            const std::vector<std::filesystem::path>& directories,
                                            const std::vector<std::filesystem::path>& folders) {
  auto root = parse_yaml(text, name);
  if (!root) return root.failure();
  return interpret(*root, text, name, folders, directories);
}

Result<PipelineConfig> read_pipeline_config_file(const std::string& path,
                                                 const std::vector<std::filesystem::path>& directories,
                                                 std::vector<std::filesystem::path> folders) {
  auto text = read_limited(path);
  if (!text) return text.failure();
  auto root = parse_yaml(*text, path);
  if (!root) return root.failure();
  folders.insert(folders.begin(), std::filesystem::absolute(utf8_path(path)).parent_path());
  return interpret(*root, *text, path, folders, directories);
}

}  // namespace odograph
