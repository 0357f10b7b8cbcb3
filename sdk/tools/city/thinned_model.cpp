// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/thinned_model.hpp"

#include <fstream>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "sdk/tools/simulation/random.hpp"

namespace odograph {

Result<size_t> write_thinned_model(const std::filesystem::path& model, const std::filesystem::path& output,
                                   double missing, uint64_t seed) {
  std::ifstream in(model, std::ios::binary);
  if (!in) return Failure{ODO_E_NOT_FOUND, model.string() + ": no such file"};
  auto root = nlohmann::ordered_json::parse(in, nullptr, false);
  if (!root.is_object() || !root.contains("CityObjects") || !root["CityObjects"].is_object())
    return Failure{ODO_E_DATA, model.string() + ": not CityJSON"};
  auto& objects = root["CityObjects"];
  const auto type_of = [](const auto& object) { return object.is_object() ? object.value("type", std::string()) : ""; };
  Random random(seed, 181);
  std::set<std::string> gone;
  size_t left = 0;
  for (const auto& [id, object] : objects.items()) {
    if (type_of(object) != "Building") continue;
    if (random.uniform() < missing)
      gone.insert(id);
    else
      ++left;
  }
  for (const auto& [id, object] : objects.items())
    if (type_of(object) == "BuildingPart" && object.contains("parents"))
      for (const auto& parent : object["parents"])
        if (parent.is_string() && gone.count(parent.template get<std::string>())) gone.insert(id);
  for (const std::string& id : gone) objects.erase(id);
  std::ofstream out(output, std::ios::binary);
  out << root.dump();
  if (!out.flush()) return Failure{ODO_E_NOT_FOUND, output.string() + ": cannot be written"};
  return left;
}

}  // namespace odograph
