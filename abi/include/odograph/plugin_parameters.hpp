// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for plugin authors, part 2: the parameter table. Each row has the name, unit and range of a
// parameter and the member that it sets; the initialiser of the member is the default.
#ifndef ODOGRAPH_PLUGIN_PARAMETERS_HPP
#define ODOGRAPH_PLUGIN_PARAMETERS_HPP

#include <odograph/plugin_messages.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <variant>

namespace odo {
inline namespace ODO_DETAIL_VERSION {

/// One row of the parameter table, created by real(), reals(), integer(), boolean(), text() or choice(). min and max
/// are inclusive and in `unit`; `choices` are separated by '|'.
template <class T> struct Parameter {
  using Member = std::variant<double T::*, int64_t T::*, bool T::*, std::string T::*, std::array<double, 3> T::*>;
  uint32_t type;
  const char* name;
  const char* unit;
  double min;
  double max;
  const char* choices;
  const char* help;
  Member member;
};

template <class T>
Parameter<T> real(const char* name, const char* unit, double min, double max, double T::*member, const char* help) {
  return {ODO_PARAMETER_REAL, name, unit, min, max, "", help, member};
}
template <class T>
Parameter<T> reals(const char* name, const char* unit, double min, double max, std::array<double, 3> T::*member,
                   const char* help) {
  return {ODO_PARAMETER_REALS, name, unit, min, max, "", help, member};
}
template <class T>
Parameter<T> integer(const char* name, int64_t min, int64_t max, int64_t T::*member, const char* help) {
  return {ODO_PARAMETER_INT, name, "", static_cast<double>(min), static_cast<double>(max), "", help, member};
}
template <class T> Parameter<T> boolean(const char* name, bool T::*member, const char* help) {
  return {ODO_PARAMETER_BOOL, name, "", 0, 1, "", help, member};
}
template <class T> Parameter<T> text(const char* name, std::string T::*member, const char* help) {
  return {ODO_PARAMETER_STRING, name, "", 0, 0, "", help, member};
}
template <class T>
Parameter<T> choice(const char* name, const char* choices, std::string T::*member, const char* help) {
  return {ODO_PARAMETER_CHOICE, name, "", 0, 0, choices, help, member};
}

namespace detail {

inline std::string number_text(double value) {
  char buffer[40];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    if (std::strtod(buffer, nullptr) == value) break;
  }
  for (char* c = buffer; *c; ++c)
    if (*c == ',') *c = '.';
  return buffer;
}

template <class T> std::string default_text(const T& object, const Parameter<T>& parameter) {
  return std::visit(
      [&](auto member) -> std::string {
        const auto& value = object.*member;
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, bool>) return value ? "true" : "false";
        else if constexpr (std::is_same_v<V, double>) return number_text(value);
        else if constexpr (std::is_same_v<V, int64_t>) return std::to_string(value);
        else if constexpr (std::is_same_v<V, std::string>) return value;
        else return "[" + number_text(value[0]) + ", " + number_text(value[1]) + ", " + number_text(value[2]) + "]";
      },
      parameter.member);
}

}  // namespace detail
}  // inline namespace
}  // namespace odo

#endif
