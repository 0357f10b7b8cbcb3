// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for plugin authors: which optional members a plugin class has (plugin.hpp).
#ifndef ODOGRAPH_PLUGIN_TRAITS_HPP
#define ODOGRAPH_PLUGIN_TRAITS_HPP

#include <odograph/plugin_messages.hpp>

#include <string_view>
#include <type_traits>
#include <utility>

namespace odo {
inline namespace ODO_DETAIL_VERSION {
namespace detail {

template <class T, class = void> struct has_configured : std::false_type {};
template <class T> struct has_configured<T, std::void_t<decltype(std::declval<T&>().configured())>> : std::true_type {};
template <class T, class = void> struct has_configured_with_host : std::false_type {};
template <class T>
struct has_configured_with_host<T, std::void_t<decltype(std::declval<T&>().configured(std::declval<Output&>()))>>
    : std::true_type {};
template <class T, class = void> struct has_reset : std::false_type {};
template <class T> struct has_reset<T, std::void_t<decltype(std::declval<T&>().reset())>> : std::true_type {};
template <class T, class = void> struct has_save : std::false_type {};
template <class T> struct has_save<T, std::void_t<decltype(std::declval<const T&>().save())>> : std::true_type {};
template <class T, class = void> struct has_save_map : std::false_type {};
template <class T>
struct has_save_map<T, std::void_t<decltype(std::declval<const T&>().save_map())>> : std::true_type {};
template <class T, class = void> struct has_extension : std::false_type {};
template <class T>
struct has_extension<T, std::void_t<decltype(std::declval<T&>().extension(std::string_view()))>> : std::true_type {};
template <class T, class = void> struct has_woken : std::false_type {};
template <class T>
struct has_woken<T, std::void_t<decltype(std::declval<T&>().woken(std::declval<Output&>()))>> : std::true_type {};
template <class T, class = void> struct has_flags : std::false_type {};
template <class T> struct has_flags<T, std::void_t<decltype(T::flags)>> : std::true_type {};
template <class T, class = void> struct has_extra_outputs : std::false_type {};
template <class T> struct has_extra_outputs<T, std::void_t<decltype(T::extra_outputs)>> : std::true_type {};

}  // namespace detail
}  // namespace ODO_DETAIL_VERSION
}  // namespace odo

#endif
