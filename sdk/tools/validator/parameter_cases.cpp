// SPDX-License-Identifier: Apache-2.0
//
// The parameter table and the handling of values.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/validator/case_fixture.hpp"

namespace odograph {
CASES(parameter)
namespace {

/// Checks each row; returns the first non-empty result, preceded by the parameter's name.
template <class Ask>
Verdict of_each_parameter(CaseFixture& fixture, Ask&& ask) {
  if (fixture.choice.manifest.parameters.empty()) return not_applicable("it has no parameters");
  for (const Spec& spec : fixture.choice.manifest.parameters)
    if (const std::string found = ask(spec); !found.empty()) return "'" + spec.name + "' " + found;
  return "";
}

bool is_number(const Spec& spec) {
  return spec.type == SpecType::real || spec.type == SpecType::integer || spec.type == SpecType::reals;
}

/// Checks a text as the host does when it is in a config.
std::string refusal_of(const Spec& spec, const std::string& text) {
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, ""};
  };
  Spec table{.name = "parameters", .type = SpecType::map, .children = {spec}};
  const bool quote = spec.type == SpecType::text;
  const auto node = parse_yaml(spec.name + ": " + (quote ? "\"" + text + "\"" : text), "default");
  if (!node) return node.failure().text;
  const auto checked = validate(*node, table, "default", none);
  return checked ? "" : checked.failure().text;
}

/// Whether a text is a product or quotient of powers of SI units (and px): "m/s^2", "rad/s*Hz^(1/2)", "1/s".
bool is_si_unit(std::string_view text) {
  constexpr std::string_view known[] = {"m",  "kg", "s",  "A", "K", "mol", "cd", "rad", "sr",
                                        "Hz", "N",  "Pa", "J", "W", "V",   "T",  "lx",  "px"};
  const auto take = [&](std::string_view token) {
    const bool there = text.starts_with(token);
    if (there) text.remove_prefix(token.size());
    return there;
  };
  const auto take_while = [&](auto&& fits) {
    const auto end = std::find_if_not(text.begin(), text.end(), [&](unsigned char c) { return fits(c) != 0; });
    const std::string_view taken(text.data(), static_cast<size_t>(end - text.begin()));
    text.remove_prefix(taken.size());
    return taken;
  };
  const auto take_number = [&] { return !take_while([](unsigned char c) { return std::isdigit(c); }).empty(); };
  if (text.starts_with("1/")) text.remove_prefix(2);
  do {
    const std::string_view name = take_while([](unsigned char c) { return std::isalpha(c); });
    if (std::find(std::begin(known), std::end(known), name) == std::end(known)) return false;
    if (!take("^")) continue;
    const bool fraction = take("(");
    take("-");
    if (!take_number() || (fraction && !(take("/") && take_number() && take(")")))) return false;
  } while (take("*") || take("/"));
  return text.empty();
}

CASE(parameter, "parameters.names", "has parameters in lower_case, each once", 10, 0) {
  const auto& all = fixture.choice.manifest.parameters;
  return of_each_parameter(fixture, [&](const Spec& spec) -> std::string {
    const bool good = !spec.name.empty() && std::all_of(spec.name.begin(), spec.name.end(), [](char c) {
      return std::islower(static_cast<unsigned char>(c)) || std::isdigit(static_cast<unsigned char>(c)) || c == '_';
    });
    if (!good) return "is not a name in lower_case";
    const auto same = std::count_if(all.begin(), all.end(), [&](const Spec& other) { return other.name == spec.name; });
    return same == 1 ? "" : "is listed " + std::to_string(same) + " times";
  });
}

CASE(parameter, "parameters.units", "has units of the SI", 10, 0) {
  return of_each_parameter(fixture, [](const Spec& spec) -> std::string {
    if (spec.unit.empty() || !is_number(spec)) return "";
    return !is_si_unit(spec.unit)
               ? "has the unit '" + spec.unit + "'; expected one of the SI, such as m, rad, m/s^2, m^(3/4)*s^(1/2)"
               : "";
  });
}

CASE(parameter, "parameters.help", "explains each parameter", 10, 0) {
  return of_each_parameter(fixture,
                           [](const Spec& spec) -> std::string { return spec.help.empty() ? "has no help" : ""; });
}

CASE(parameter, "parameters.ranges", "has ranges with min not above max", 10, 0) {
  return of_each_parameter(fixture, [](const Spec& spec) -> std::string {
    if (!std::isfinite(spec.min) || !std::isfinite(spec.max)) return "has a bound that is not finite";
    return spec.min <= spec.max ? ""
                                : "has min = " + std::to_string(spec.min) + " above max = " + std::to_string(spec.max);
  });
}

CASE(parameter, "parameters.defaults", "has defaults that are valid in a config", 10, 0) {
  return of_each_parameter(fixture, [](const Spec& spec) -> std::string {
    if (spec.fallback.empty() && !is_number(spec)) return "";
    return refusal_of(spec, spec.fallback);
  });
}

CASE(parameter, "parameters.choices", "has choices, the default among them", 10, 0) {
  return of_each_parameter(fixture, [](const Spec& spec) -> std::string {
    if (spec.type != SpecType::choice) return "";
    const auto all = split(spec.choices, '|');
    if (all.empty()) return "is a choice without choices";
    return std::count(all.begin(), all.end(), spec.fallback)
               ? ""
               : "has the default '" + spec.fallback + "', which is not a choice";
  });
}

CASE(parameter, "parameters.counts", "has lists of 1 to 64 numbers", 10, 0) {
  return of_each_parameter(fixture, [](const Spec& spec) -> std::string {
    const bool good = spec.type != SpecType::reals || (spec.count >= 1 && spec.count <= 64);
    return good ? "" : "has count = " + std::to_string(spec.count) + "; expected 1 to 64";
  });
}

/// Starts with a value at an end of its range; refusal with ODO_E_CONFIG and a report is also good.
CASE(parameter, "parameters.ends", "accepts values at the ends of their ranges, or refuses them with a report", 30, 0) {
  bool any = false;
  for (size_t i = 0; i < fixture.choice.parameters.size(); ++i) {
    const auto& [spec, value] = fixture.choice.parameters[i];
    if ((spec.type != SpecType::real && spec.type != SpecType::integer) || !spec.bounded()) continue;
    any = true;
    for (const double end : {spec.min, spec.max}) {
      const Value kept = fixture.choice.parameters[i].second;
      fixture.choice.parameters[i].second.real = end;
      fixture.choice.parameters[i].second.integer = static_cast<int64_t>(end);
      auto driver = fixture.driver();
      const size_t told = fixture.reports.size();
      const int32_t status = driver->start(values_of(fixture.choice));
      fixture.choice.parameters[i].second = kept;
      if (status >= 0 || (status == ODO_E_CONFIG && fixture.reports.size() > told)) continue;
      return "'" + spec.name + "' = " + std::to_string(end) + ": status " + std::to_string(status) +
             "; expected ODO_OK, or ODO_E_CONFIG after a report";
    }
  }
  return any ? Verdict() : not_applicable("none of its numbers has bounds");
}

CASE(parameter, "parameters.unknown", "survives a parameter of a later version", 10, 0) {
  auto values = fixture.values;
  odo_value unknown_row{};
  unknown_row.struct_size = sizeof unknown_row;
  unknown_row.type = ODO_PARAMETER_BOOL;
  unknown_row.name = {"of_a_later_version", 18};
  values.push_back(unknown_row);
  const auto driver = fixture.driver();
  driver->start(values);
  return "";
}

CASE(parameter, "parameters.order", "accepts them in any order", 20, 2) {
  if (fixture.values.size() < 2) return not_applicable("it has less than two parameters");
  const auto straight = fixture.run(fixture.input, {});
  std::reverse(fixture.values.begin(), fixture.values.end());
  const auto reversed = fixture.run(fixture.input, {});
  return difference(straight, reversed);
}

/// Values from a newer host, whose rows are longer.
CASE(parameter, "parameters.larger_rows", "accepts the larger rows of a newer host", 20, 2) {
  struct Later {
    odo_value value;
    uint64_t more[3];
  };
  std::vector<Later> rows;
  for (const odo_value& value : fixture.values) rows.push_back({value, {~0ull, ~0ull, ~0ull}});
  for (Later& row : rows) row.value.struct_size = sizeof(Later);
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = fixture.driver();
  int32_t status = driver->create();
  if (status >= 0)
    status = fixture.table().configure(driver->instance(), rows.empty() ? nullptr : &rows[0].value,
                                       static_cast<uint32_t>(rows.size()), sizeof(Later));
  if (status >= 0) status = driver->activate();
  if (status < 0) return "status " + std::to_string(status);
  driver->process(fixture.input);
  return difference(plain, driver->bytes());
}

/// The values are unmapped after the call.
CASE(parameter, "parameters.copied", "keeps no pointer to the values", 20, 2) {
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = fixture.driver();
  {
    std::vector<std::string> texts;
    std::vector<std::vector<double>> reals;
    auto values = fixture.values;
    for (odo_value& value : values) {
      texts.emplace_back(value.text.data ? std::string(value.text.data, value.text.size) : std::string());
      reals.emplace_back(value.reals, value.reals + value.count);
    }
    for (size_t i = 0; i < values.size(); ++i) {
      values[i].text = {texts[i].data(), texts[i].size()};
      values[i].reals = reals[i].data();
    }
    int32_t status = driver->create();
    if (status >= 0) status = driver->configure(values);
    if (status < 0) return "status " + std::to_string(status);
    for (std::string& text : texts) std::fill(text.begin(), text.end(), '?');
    for (auto& list : reals) std::fill(list.begin(), list.end(), 1e30);
    std::memset(static_cast<void*>(values.data()), 0xA5, values.size() * sizeof(odo_value));
  }
  if (const int32_t status = driver->activate(); status < 0) return "status " + std::to_string(status);
  driver->process(fixture.input);
  return difference(plain, driver->bytes());
}

}  // namespace

}  // namespace odograph
