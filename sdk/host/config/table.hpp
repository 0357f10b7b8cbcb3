// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/config/spec.hpp"

/// Shorthand constructors for the entries of a schema table.
namespace odograph::table {

inline Spec map(const char* name, const char* help, std::vector<Spec> children) {
  return {.name = name, .type = SpecType::map, .help = help, .children = std::move(children)};
}
inline Spec real(const char* name, const char* unit, double min, double max, const char* fallback, const char* help) {
  return {
      .name = name, .type = SpecType::real, .unit = unit, .min = min, .max = max, .fallback = fallback, .help = help};
}
inline Spec integer(const char* name, double min, double max, const char* fallback, const char* help) {
  return {.name = name, .type = SpecType::integer, .min = min, .max = max, .fallback = fallback, .help = help};
}
inline Spec choice(const char* name, const char* choices, const char* fallback, const char* help) {
  return {.name = name, .type = SpecType::choice, .fallback = fallback, .choices = choices, .help = help};
}
inline Spec boolean(const char* name, const char* fallback, const char* help) {
  return {.name = name, .type = SpecType::boolean, .fallback = fallback, .help = help};
}

}  // namespace odograph::table
