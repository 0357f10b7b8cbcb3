// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/command_line/plugin_skeleton.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <vector>

#include "sdk/host/base/nearest.hpp"
#include "sdk/tools/command_line/plugin_skeleton_python.hpp"
#include "sdk/tools/command_line/plugin_skeleton_rust.hpp"
#include "sdk/tools/command_line/plugin_skeleton_texts.hpp"

namespace odograph {
namespace {

/// The parameter of the skeleton, by kind: unit, minimum, maximum, default, help.
struct GainText {
  const char *unit, *low, *high, *fallback, *help;
};
GainText gain_of(const std::string& kind) {
  if (kind == "attitude")
    return {"1/s", "0.01", "10", "0.5", "rate at which the accelerometer corrects the inclination (judgement)"};
  if (kind == "step_estimator") return {"m", "0.2", "2", "0.7", "length of a step (judgement)"};
  if (kind == "scale_source") return {"m/s", "0.1", "10", "1.4", "speed of the camera (judgement)"};
  return {"", "0.1", "10", "1", "factor on the smallest sigma (judgement)"};
}

std::string replaced(std::string text, const std::vector<std::pair<std::string, std::string>>& words) {
  for (const auto& [from, to] : words)
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

/// Members in C syntax: no initialisers (the instance is zero-initialised), int for bool.
std::string c_members(const std::string& members) {
  std::string out;
  for (size_t i = 0; i < members.size(); ++i) {
    if (members.compare(i, 3, " = ") == 0) {
      i += 3;
      if (members[i] == '{') i = members.find('}', i) + 1;
      while (members[i] != ',' && members[i] != ';') ++i;
    }
    out += members[i];
  }
  return replaced(out, {{"bool ", "int "}});
}

/// The files of a language, by name, and the parts that depend on the kind.
struct Template {
  std::vector<std::pair<std::string, const char*>> files;
  std::vector<std::pair<std::string, std::string>> words;
};

template <class Rows>
const auto& row_of(const Rows& rows, const std::string& kind) {
  return *std::find_if(std::begin(rows), std::end(rows), [&](const auto& row) { return kind == row.kind; });
}

Template native(const Skeleton& kind, const std::string& file, bool in_c) {
  const std::string source = file + (in_c ? ".c" : ".cpp");
  const std::string state = *kind.state ? std::string(" private:\n") + kind.state : "";
  return {{{source, in_c ? kC : kCpp}, {"CMakeLists.txt", kCMake}, {"README.md", kReadme}},
          {{"@BODY@", in_c ? kind.c_body : kind.cpp_body},
           {"@STATE@", in_c ? c_members(kind.state) : state},
           {"@SOURCE@", source},
           {"@LANGUAGE@", in_c ? "C" : "CXX"},
           {"@LIBRARIES@", in_c ? " m" : ""},
           {"@STANDARD@", in_c ? "C_STANDARD 99 C_VISIBILITY_PRESET hidden"
                               : "CXX_STANDARD 17 CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON"},
           {"@STATIC@", in_c ? "" : "-static-libstdc++ "}}};
}

Template template_of(const Skeleton& kind, const std::string& file, const std::string& language) {
  if (language == "rust") {
    const RustSkeleton& row = row_of(kRustSkeletons, kind.kind);
    return {{{"src/lib.rs", kRust}, {"Cargo.toml", kCargo}, {"README.md", kRustReadme}},
            {{"@BODY@", row.body}, {"@STATE@", row.state}, {"@MESSAGE@", row.input}}};
  }
  if (language == "python") {
    const PythonSkeleton& row = row_of(kPythonSkeletons, kind.kind);
    return {{{file + ".py", kPython}, {"CMakeLists.txt", kPythonCMake}, {"README.md", kReadme}},
            {{"@BODY@", row.body}, {"@STATE@", row.state}, {"@INTERFACE@", kind.interface_macro}}};
  }
  return native(kind, file, language == "c");
}

}  // namespace

Result<bool> write_plugin_skeleton(const std::string& kind, const std::string& id, const std::filesystem::path& folder,
                                   const std::string& language) {
  std::vector<std::string> kinds;
  const Skeleton* found = nullptr;
  for (const Skeleton& one : kSkeletons) {
    kinds.emplace_back(one.kind);
    if (kind == one.kind) found = &one;
  }
  if (!found)
    return Failure{ODO_E_ARGUMENT, "kind '" + kind + "'; expected one of " + join(kinds) + did_you_mean(kind, kinds)};
  const auto slash = id.find('/');
  const std::string file = slash == std::string::npos ? "" : id.substr(slash + 1);
  const bool good = !file.empty() && slash > 0 &&
                    id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_/") == std::string::npos &&
                    file.find('/') == std::string::npos && !std::isdigit(static_cast<unsigned char>(file[0]));
  if (!good) return Failure{ODO_E_ARGUMENT, "id '" + id + "'; expected group/name in lower case"};
  const GainText gain = gain_of(kind);
  auto [files, words] = template_of(*found, file, language);
  words.insert(words.end(), {{"@ID@", id},
                             {"@KIND@", kind},
                             {"@SUMMARY@", found->summary},
                             {"@INTERFACE@", found->interface_macro},
                             {"@INPUT@", found->input},
                             {"@UNIT@", gain.unit},
                             {"@LOW@", gain.low},
                             {"@HIGH@", gain.high},
                             {"@DEFAULT@", gain.fallback},
                             {"@HELP@", gain.help},
                             {"@FILE@", file}});
  const std::string choice = kind == "absolute_fixer" ? "absolute_fixers" : kind;
  const std::string yaml = "odograph: 1\nplugins:\n  search: [build]\n" + std::string(found->rest) + choice +
                           ":\n  plugin: " + id + "\n  parameters: {gain: " + gain.fallback + "}\n";
  files.emplace_back("pipeline.yaml", yaml.c_str());
  std::error_code error;
  for (const auto& [name, text] : files) {
    if (std::filesystem::exists(folder / name, error))
      return Failure{ODO_E_ARGUMENT, (folder / name).string() + " already exists"};
    std::filesystem::create_directories((folder / name).parent_path(), error);
    std::ofstream out(folder / name, std::ios::binary);
    out << replaced(text, words);
    if (!out.flush()) return Failure{ODO_E_IO, (folder / name).string() + ": cannot be written"};
  }
  return true;
}

}  // namespace odograph
