// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/json_text.hpp"
#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/pipeline_config.hpp"

namespace odograph {
namespace {

void describe(JsonText& json, const Spec& spec);

void object(JsonText& json, const Spec& spec) {
  const auto& children = spec.children;
  json.key("type").string("object").key("additionalProperties").boolean(spec.open);
  bool required = false;
  for (const Spec& child : children) required = required || child.required;
  if (required) {
    json.key("required").open('[');
    for (const Spec& child : children)
      if (child.required) json.string(child.name);
    json.close(']');
  }
  json.key("properties").open('{');
  for (const Spec& child : children) {
    json.key(child.name).open('{');
    describe(json, child);
    json.close('}');
  }
  json.close('}');
}

void quantity(JsonText& json, const Spec& spec) {
  const auto units = compatible_units(spec.unit);
  if (units.empty()) {
    json.key("type").string("number");
    if (spec.bounded()) json.key("minimum").number(spec.min).key("maximum").number(spec.max);
    return;
  }
  json.key("oneOf").open('[').open('{').key("type").string("number");
  if (spec.bounded()) json.key("minimum").number(spec.min).key("maximum").number(spec.max);
  json.close('}').open('{').key("type").string("string");
  json.key("pattern").string("^[-+0-9.eE]+ *(" + join(units, "|") + ")$").close('}').close(']');
}

void plugin(JsonText& json) {
  json.key("type").string("object").key("additionalProperties").boolean(false);
  json.key("required").open('[').string("plugin").close(']').key("properties").open('{');
  json.key("plugin").open('{').key("type").string("string").close('}');
  json.key("parameters").open('{').key("type").open('[').string("object").string("null").close(']').close('}');
  for (const Spec& spec : plugin_choice_specs()) {
    json.key(spec.name).open('{');
    describe(json, spec);
    json.close('}');
  }
  json.close('}');
}

void describe(JsonText& json, const Spec& spec) {
  std::string help = spec.help;
  if (!spec.unit.empty()) help += (help.empty() ? "" : "; ") + std::string("in ") + spec.unit;
  if (!spec.fallback.empty()) help += (help.empty() ? "" : "; ") + std::string("default ") + spec.fallback;
  if (!help.empty()) json.key("description").string(help);
  switch (spec.type) {
    case SpecType::map: object(json, spec); break;
    case SpecType::boolean: json.key("type").string("boolean"); break;
    case SpecType::integer:
      json.key("type").string("integer");
      if (spec.bounded()) json.key("minimum").number(spec.min).key("maximum").number(spec.max);
      break;
    case SpecType::real: quantity(json, spec); break;
    case SpecType::reals: {
      Spec one = spec;
      json.key("type")
          .string("array")
          .key("minItems")
          .number(double(spec.count))
          .key("maxItems")
          .number(double(spec.count));
      json.key("items").open('{');
      quantity(json, one);
      json.close('}');
      break;
    }
    case SpecType::choice:
      json.key("enum").open('[');
      for (const auto& c : split(spec.choices, '|')) json.string(c);
      json.close(']');
      break;
    case SpecType::text: json.key("type").string("string"); break;
    case SpecType::list:
      json.key("type").string("array").key("items").open('{');
      describe(json, spec.children.front());
      json.close('}');
      break;
    case SpecType::plugins:
      json.key("oneOf").open('[').open('{');
      plugin(json);
      json.close('}').open('{').key("type").string("array").key("items").open('{');
      plugin(json);
      json.close('}').close('}').close(']');
      break;
  }
}

}  // namespace

std::string json_schema(const Spec& spec, const std::string& title) {
  JsonText json;
  json.open('{').key("$schema").string("http://json-schema.org/draft-07/schema#").key("title").string(title);
  describe(json, spec);
  json.close('}');
  return json.text() + "\n";
}

}  // namespace odograph
