// SPDX-License-Identifier: Apache-2.0
//
// Files of a phone's recording, and the app that wrote them.
#include <algorithm>
#include <fstream>

#include "sdk/tools/recording/phone_camera.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

constexpr size_t kMaxNames = 200'000;  // maximum number of files in a folder

/// The comma-separated fields of a line, without quotes and surrounding white space.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  for (size_t at = 0; at <= line.size();) {
    const size_t end = std::min(line.find(',', at), line.size());
    std::string field = line.substr(at, end - at);
    const char* around = " \t\r\"";
    field.erase(0, std::min(field.find_first_not_of(around), field.size()));
    field.erase(std::min(field.find_last_not_of(around) + 1, field.size()));
    fields.push_back(field);
    at = end + 1;
  }
  return fields;
}

}  // namespace

Files files_of(const fs::path& folder, std::shared_ptr<const void> keep) {
  Files files{folder, std::move(keep), {}};
  std::error_code error;
  // Two levels suffice: "Camera/123.mp4"; links are not followed.
  for (auto it = fs::recursive_directory_iterator(folder, error); it != fs::recursive_directory_iterator();
       it.increment(error)) {
    if (error || files.names.size() >= kMaxNames) break;
    if (it.depth() >= 1) it.disable_recursion_pending();
    if (it->is_symlink(error) || !it->is_regular_file(error)) continue;
    const std::string name = it->path().lexically_relative(folder).generic_string();
    if (!name.starts_with("__MACOSX") && !name.starts_with(".") && name.find("/.") == std::string::npos)
      files.names.push_back(name);
  }
  std::sort(files.names.begin(), files.names.end());
  return files;
}

const Format* format_of(const Files& files) {
  for (const Format& format : formats())
    for (const char* mark : format.marks) {
      const std::string found = files.find(mark);
      if (found.empty()) continue;
      std::string head;
      if (*format.head) std::getline(std::ifstream(files.folder / found), head);
      if (head.find(format.head) != std::string::npos) return &format;
    }
  return nullptr;
}

std::map<std::string, std::string> metadata_of(const fs::path& path) {
  std::ifstream file(path);
  std::string head, values;
  std::getline(file, head), std::getline(file, values);
  const auto names = fields_of(head);
  auto fields = fields_of(values);
  const auto device = std::find(names.begin(), names.end(), "device name");
  if (fields.size() > names.size() && device != names.end()) {  // "iPhone14,5", unquoted
    const auto at = fields.begin() + (device - names.begin());
    const auto extra = static_cast<std::ptrdiff_t>(fields.size() - names.size());
    for (auto part = at + 1; part <= at + extra; ++part) *at += "," + *part;
    fields.erase(at + 1, at + 1 + extra);
  }
  std::map<std::string, std::string> values_by_name;
  for (size_t i = 0; i < names.size() && i < fields.size(); ++i) values_by_name[names[i]] = fields[i];
  return values_by_name;
}

std::string Files::find(const std::string& pattern) const {
  const auto all = find_all(pattern);
  return all.empty() ? std::string() : all.front();
}

std::vector<std::string> Files::find_all(const std::string& pattern) const {
  for (const std::string& one : alternatives(pattern.c_str())) {
    std::vector<std::string> found;
    for (const std::string& name : names)
      if (matches(one, name)) found.push_back(name);
    if (!found.empty()) return found;
  }
  return {};
}

std::shared_ptr<const fs::path> Files::path(const std::string& name) const {
  struct Kept {
    fs::path path;
    std::shared_ptr<const void> keep;
  };
  const auto kept = std::make_shared<const Kept>(Kept{folder / name, keep});
  return {kept, &kept->path};
}

}  // namespace odograph::phone
