// SPDX-License-Identifier: Apache-2.0
//
// From the files of sdk/tools/templates, in which words between @ are replaced.
#include "sdk/tools/command_line/plugin_skeleton.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <vector>

#include <nlohmann/json.hpp>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/tools/replay/recording_cache.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kKinds = {"attitude",     "step_estimator", "vo_frontend",
                                         "scale_source", "absolute_fixer", "surface_finder"};

using Words = std::vector<std::pair<std::string, std::string>>;

/// A file and the templates that it consists of.
struct Output {
  std::string name;
  std::vector<std::string> templates;
};

/// A language: the ending of its source, the files and their words.
struct Language {
  std::string ending;
  std::vector<Output> files;
  Words words;
};

Language language_of(const std::string& language, const std::string& file, bool repository) {
  const Output readme{"README.md", {"README.md.in"}};
  Language out;
  if (language == "rust")
    out = {"rs",
           {{"src/lib.rs", {"plugin.rs.in"}}, {"Cargo.toml", {"Cargo.toml.in"}}, {"README.md", {"README_rust.md.in"}}},
           {}};
  else if (language == "python")
    out = {"py", {{file + ".py", {"plugin.py.in"}}, {"CMakeLists.txt", {"CMakeLists_python.txt.in"}}, readme}, {}};
  else if (language == "c")
    out = {"c",
           {{file + ".c", {"plugin.c.in"}}, {"CMakeLists.txt", {"CMakeLists.txt.in"}}, readme},
           {{"LANGUAGE", "C"},
            {"LIBRARIES", " m"},
            {"STANDARD", "C_STANDARD 99 C_VISIBILITY_PRESET hidden"},
            {"STATIC", ""}}};
  else
    out = {"cpp",
           {{file + ".cpp", {"plugin.cpp.in"}}, {"CMakeLists.txt", {"CMakeLists.txt.in"}}, readme},
           {{"LANGUAGE", "CXX"},
            {"LIBRARIES", ""},
            {"STANDARD", "CXX_STANDARD 17 CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON"},
            {"STATIC", "-static-libstdc++ "}}};
  if (!repository) return out;
  const std::string build = language == "rust" ? "cargo" : "cmake";
  out.files.back().templates.emplace_back("repository/README.md.in");
  out.files.insert(
      out.files.end(),
      {{"ci/check", {"repository/check_install.in", "repository/build_" + build + ".in", "repository/check_sign.in"}},
       {".github/workflows/check.yml", {"repository/github.yml.in"}},
       {".gitlab-ci.yml", {"repository/gitlab.yml.in"}},
       {".gitignore", {"repository/gitignore_" + build + ".in"}}});
  out.words.emplace_back("PACKAGES",
                         language == "rust" ? "cargo openssl" : "cmake g++ libodograph-dev ninja-build openssl");
  return out;
}

/// Installed as share/odograph/templates beside the program's folder; a build has the same place.
Result<std::string> template_text(const std::string& name) {
  const fs::path file = own_file().parent_path().parent_path() / "share/odograph/templates" / name;
  auto text = text_of(file);
  if (!text)
    return Failure{ODO_E_NOT_FOUND,
                   file.string() + ": no such file; the templates of plugins are installed with the configs"};
  return text;
}

Result<std::string> replaced(const std::vector<std::string>& templates, const Words& words) {
  std::string all;
  for (const std::string& name : templates) {
    auto text = template_text(name);
    if (!text) return text.failure();
    all += *text;
  }
  for (const auto& [word, value] : words) {
    const std::string from = '@' + word + '@';
    for (size_t at = 0; (at = all.find(from, at)) != std::string::npos; at += value.size())
      all.replace(at, from.size(), value);
  }
  return all;
}

Result<bool> write_new_file(const fs::path& file, const std::string& text) {
  std::error_code error;
  if (fs::exists(file, error)) return Failure{ODO_E_ARGUMENT, file.string() + " already exists"};
  fs::create_directories(file.parent_path(), error);
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  return true;
}

}  // namespace

Result<bool> write_plugin_skeleton(const std::string& kind, const std::string& id, const fs::path& folder,
                                   const std::string& language, bool repository) {
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end())
    return Failure{ODO_E_ARGUMENT, "kind '" + kind + "'; expected one of " + join(kKinds) + did_you_mean(kind, kKinds)};
  const auto slash = id.find('/');
  const std::string file = slash == std::string::npos ? "" : id.substr(slash + 1);
  const bool good = !file.empty() && slash > 0 &&
                    id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_/") == std::string::npos &&
                    file.find('/') == std::string::npos && !std::isdigit(static_cast<unsigned char>(file[0]));
  if (!good) return Failure{ODO_E_ARGUMENT, "id '" + id + "'; expected group/name in lower case"};
  Language chosen = language_of(language, file, repository);
  Words words;
  for (const std::string part : {"body", "state"}) {
    auto text = template_text(kind + '/' + part + '.' + chosen.ending + ".in");
    if (!text) return text.failure();
    words.emplace_back(part == "body" ? "BODY" : "STATE", std::move(*text));
  }
  const auto of_kind = template_text(kind + "/words.json");
  if (!of_kind) return of_kind.failure();
  const auto own = nlohmann::json::parse(*of_kind);
  for (const auto& [word, value] : own.items()) words.emplace_back(word, value.get<std::string>());
  words.insert(words.end(), chosen.words.begin(), chosen.words.end());
  words.insert(words.end(), {{"ID", id}, {"KIND", kind}, {"FILE", file}, {"SOURCE", chosen.files.front().name}});
  chosen.files.push_back({"pipeline.yaml", {kind + "/pipeline.yaml.in"}});
  for (const Output& output : chosen.files) {
    const auto text = replaced(output.templates, words);
    if (!text) return text.failure();
    if (const auto written = write_new_file(folder / output.name, *text); !written) return written.failure();
  }
  std::error_code error;
  if (repository)
    fs::permissions(folder / "ci/check", fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                    fs::perm_options::add, error);
  return true;
}

}  // namespace odograph
