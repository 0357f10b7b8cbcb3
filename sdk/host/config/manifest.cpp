// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/manifest.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>

#include <odograph/messages.h>
#include <sha2.h>

#include "sdk/host/base/json_text.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {
namespace {

constexpr size_t kChunk = 1 << 16;  // bytes read from a library at a time
constexpr char kHexDigits[] = "0123456789abcdef";

constexpr struct {
  uint32_t code;
  SpecType type;
  const char* name;
} kTypes[] = {
    {ODO_PARAMETER_BOOL, SpecType::boolean, "bool"},    {ODO_PARAMETER_INT, SpecType::integer, "int"},
    {ODO_PARAMETER_REAL, SpecType::real, "real"},       {ODO_PARAMETER_STRING, SpecType::text, "string"},
    {ODO_PARAMETER_CHOICE, SpecType::choice, "choice"}, {ODO_PARAMETER_REALS, SpecType::reals, "reals"},
};

Spec text_spec(const char* name, const char* help, bool required = true) {
  return {.name = name, .type = SpecType::text, .help = help, .required = required};
}

Spec list_of(const char* name, Spec item, const char* help) {
  return {.name = name, .type = SpecType::list, .help = help, .required = true, .children = {std::move(item)}};
}

bool is_readable_default(const Spec& spec) {
  return spec.type != SpecType::real || spec.fallback.empty() || parse_quantity(spec.fallback, spec.unit).ok();
}

std::string default_fault(const Spec& spec) {
  return "parameter '" + spec.name + "': its default '" + spec.fallback + "' is no number in " + spec.unit;
}

}  // namespace

const Spec& manifest_spec() {
  static const Spec spec = [] {
    Spec whole{.name = "version", .type = SpecType::integer, .min = 0, .max = 65535, .help = "major, then minor"};
    Spec parameter{.name = "parameter", .type = SpecType::map, .open = true};
    parameter.children = {
        text_spec("name", "lower_case"),
        text_spec("type", "of the value: bool, int, real, string, choice, reals; a row of another type is ignored"),
        text_spec("unit", "SI", false),
        {.name = "min", .type = SpecType::real, .fallback = "0", .help = "inclusive"},
        {.name = "max", .type = SpecType::real, .fallback = "0", .help = "inclusive; no bound where both are 0"},
        text_spec("default", "as written in YAML, in the unit", false),
        text_spec("choices", "separated by |", false),
        {.name = "count", .type = SpecType::integer, .min = 1, .max = 64, .fallback = "1", .help = "of reals"},
        text_spec("help", "one sentence", false),
    };
    Spec root{.name = "manifest", .type = SpecType::map, .open = true};
    root.children = {
        {.name = "odoplugin",
         .type = SpecType::integer,
         .min = 1,
         .max = 1,
         .help = "version of this format",
         .required = true},
        text_spec("id", "group/name"),
        text_spec("version", "major.minor.patch"),
        text_spec("summary", "one sentence"),
        list_of("interfaces", text_spec("interface", "odo.KIND/VERSION"), "kinds it serves"),
        list_of("abi", whole, "major, then minor"),
        text_spec("library", "file name, beside the manifest"),
        {.name = "entry",
         .type = SpecType::text,
         .fallback = ODO_PLUGIN_ENTRY_SYMBOL,
         .help = "the entry function; a library may have several plugins, each with a manifest of its own"},
        text_spec("sha256", "of the library, hex; without it the library is not checked", false),
        list_of("parameters", parameter, "the plugin's parameter table"),
    };
    return root;
  }();
  return spec;
}

Result<Manifest> read_manifest(const std::filesystem::path& path) {
  auto text = read_limited(path.string());
  return text ? parse_manifest(std::move(*text), path) : Result<Manifest>(text.failure());
}

Result<Manifest> parse_manifest(std::string text, const std::filesystem::path& path) {
  auto node = parse_yaml(text, path.string());  // JSON is a subset of YAML, and this parser has limits and positions
  if (!node) return node.failure();
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  auto checked = validate(*node, manifest_spec(), path.string(), none);
  if (!checked) return checked.failure();
  const Value& value = *checked;
  Manifest manifest;
  manifest.path = path;
  manifest.text = std::move(text);
  manifest.id = value["id"].text;
  manifest.version = value["version"].text;
  manifest.summary = value["summary"].text;
  manifest.sha256 = value["sha256"].text;
  manifest.entry_symbol = value["entry"].text;
  for (const Value& item : value["interfaces"].items) manifest.interfaces.push_back(item.text);
  const auto& abi = value["abi"].items;
  if (abi.size() != 2)
    return Failure{ODO_E_CONFIG, at(path.string(), value["abi"].mark, "abi: expected [major, minor]")};
  manifest.abi_major = static_cast<uint32_t>(abi[0].integer);
  manifest.abi_minor = static_cast<uint32_t>(abi[1].integer);
  const std::filesystem::path library = utf8_path(value["library"].text);
  if (library.has_parent_path() || library.empty())
    return Failure{ODO_E_CONFIG, at(path.string(), value["library"].mark,
                                    "library: '" + library.string() + "'; expected a file name beside the manifest")};
  manifest.library = std::filesystem::absolute(path).parent_path() / library;
  for (const Value& item : value["parameters"].items) {
    Spec spec;
    spec.name = item["name"].text;
    const auto type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                   [&](const auto& known) { return item["type"].text == known.name; });
    if (type == std::end(kTypes)) continue;  // of a newer plugin, which keeps its default
    spec.type = type->type;
    spec.unit = item["unit"].text;
    spec.min = item["min"].real;
    spec.max = item["max"].real;
    spec.fallback = item["default"].text;
    spec.choices = item["choices"].text;
    spec.count = static_cast<size_t>(item["count"].integer);
    spec.help = item["help"].text;
    if (!is_readable_default(spec))
      return Failure{ODO_E_CONFIG, at(path.string(), item["default"].mark, default_fault(spec))};
    manifest.parameters.push_back(std::move(spec));
  }
  return manifest;
}

Result<std::vector<Spec>> parameter_specs(const odo_plugin& plugin) {
  std::vector<Spec> specs;
  if (plugin.parameter_count > 0 && (!plugin.parameters || plugin.parameter_stride < ODO_PARAMETER_SIZE_MIN))
    return Failure{ODO_E_DATA, "its parameter table has rows of " + std::to_string(plugin.parameter_stride) +
                                   " bytes; expected at least " + std::to_string(ODO_PARAMETER_SIZE_MIN)};
  for (uint32_t i = 0; i < plugin.parameter_count; ++i) {
    odo_parameter row{};  // zero for members unknown to an older plugin
    std::memcpy(&row, reinterpret_cast<const char*>(plugin.parameters) + size_t(i) * plugin.parameter_stride,
                std::min<size_t>(plugin.parameter_stride, sizeof row));
    Spec spec;
    spec.name = text(row.name);
    const auto type =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& known) { return row.type == known.code; });
    if (type == std::end(kTypes)) continue;  // of a newer plugin, which keeps its default
    spec.type = type->type;
    spec.unit = text(row.unit);
    spec.min = row.min;
    spec.max = row.max;
    spec.fallback = text(row.default_text);
    spec.choices = text(row.choices);
    spec.count = spec.type == SpecType::reals ? row.count : 1;
    spec.help = text(row.help);
    if (!is_readable_default(spec)) return Failure{ODO_E_DATA, default_fault(spec)};
    specs.push_back(std::move(spec));
  }
  return specs;
}

Result<Manifest> manifest_of(const odo_plugin& plugin, odo_plugin_entry entry) {
  auto parameters = parameter_specs(plugin);
  if (!parameters) return parameters.failure();
  Manifest manifest;
  manifest.entry = entry;
  manifest.id = text(plugin.id);
  manifest.version = text(plugin.version);
  manifest.summary = text(plugin.summary);
  for (uint32_t i = 0; i < plugin.interface_count; ++i) manifest.interfaces.push_back(text(plugin.interfaces[i]));
  manifest.abi_major = plugin.abi_major;
  manifest.abi_minor = plugin.abi_minor;
  manifest.parameters = std::move(*parameters);
  return manifest;
}

std::string write_manifest(const odo_plugin& plugin, const std::string& library, const std::string& sha256) {
  JsonText json;
  json.open('{');
  json.key("odoplugin").number(1);
  json.key("id").string(text(plugin.id));
  json.key("version").string(text(plugin.version));
  json.key("summary").string(text(plugin.summary));
  json.key("interfaces").open('[');
  for (uint32_t i = 0; i < plugin.interface_count; ++i) json.string(text(plugin.interfaces[i]));
  json.close(']');
  json.key("abi").open('[').number(plugin.abi_major).number(plugin.abi_minor).close(']');
  json.key("library").string(library);
  json.key("sha256").string(sha256);
  json.key("parameters").open('[');
  const auto specs = parameter_specs(plugin);
  if (specs) {
    for (const Spec& spec : *specs) {
      const char* type = "string";
      for (const auto& entry : kTypes)
        if (entry.type == spec.type) type = entry.name;
      json.open('{').key("name").string(spec.name).key("type").string(type).key("unit").string(spec.unit);
      json.key("min").number(spec.min).key("max").number(spec.max).key("default").string(spec.fallback);
      json.key("choices").string(spec.choices).key("count").number(static_cast<double>(spec.count));
      json.key("help").string(spec.help).close('}');
    }
  }
  json.close(']').close('}');
  return json.text() + "\n";
}

Result<std::string> sha256_of(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return Failure{ODO_E_NOT_FOUND, file.string() + ": is not a readable file"};
  std::ifstream in(file, std::ios::binary);
  SHA2_CTX hash;
  SHA256Init(&hash);
  std::vector<char> chunk(kChunk);
  while (in) {
    in.read(chunk.data(), kChunk);
    SHA256Update(&hash, reinterpret_cast<const uint8_t*>(chunk.data()), static_cast<size_t>(in.gcount()));
  }
  if (!in.eof()) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be read"};
  uint8_t digest[SHA256_DIGEST_LENGTH];
  SHA256Final(digest, &hash);
  std::string hex;
  for (const uint8_t byte : digest) hex += {kHexDigits[byte >> 4], kHexDigits[byte & 15]};
  return hex;
}

}  // namespace odograph
