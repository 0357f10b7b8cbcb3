// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for plugin authors, part 1: messages, events, reports and services. To use a vendor
// message, define its type number:
//
//   struct acme_wifi { odo_header header; double rssi_dbm; };
//   template <> struct odo::type_of<acme_wifi> : std::integral_constant<uint32_t, ODO_TYPE_VENDOR(7, 1)> {};
#ifndef ODOGRAPH_PLUGIN_MESSAGES_HPP
#define ODOGRAPH_PLUGIN_MESSAGES_HPP

#include <odograph/messages.h>
#include <odograph/plugin.h>

#include <cstddef>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/* Inline namespace of this version, with hidden visibility: plugins built with other versions of these headers share no
 * symbols with it in one process. */
#if defined(__GNUC__)
#define ODO_DETAIL_VERSION v2 __attribute__((visibility("hidden")))
#else
#define ODO_DETAIL_VERSION v2
#endif

namespace odo {
inline namespace ODO_DETAIL_VERSION {

/// Exception with a status. If a plugin throws it, the call returns this status; other exceptions become ODO_E_ERROR.
class Error : public std::runtime_error {
 public:
  Error(int32_t status, const std::string& text) : std::runtime_error(text), status_(status) {}
  int32_t status() const noexcept { return status_; }

 private:
  int32_t status_;
};

inline odo_string str(std::string_view text) { return {text.data(), static_cast<uint64_t>(text.size())}; }
inline std::string_view view(const odo_string& text) {
  return text.size == 0 ? std::string_view() : std::string_view(text.data, static_cast<size_t>(text.size));
}

/// Type number of a message struct.
template <class Message> struct type_of;
#define ODO_DETAIL_TYPE(number, type, name, min_size) \
  template <> struct type_of<type> : std::integral_constant<uint32_t, number> {};
ODO_FOR_EACH_MESSAGE(ODO_DETAIL_TYPE)
#undef ODO_DETAIL_TYPE

/// Minimum accepted size of a message: that of version 1.0, or the full size of a vendor message.
template <class Message> struct min_size_of : std::integral_constant<uint32_t, sizeof(Message)> {};
#define ODO_DETAIL_SIZE(number, type, name, min_size) \
  template <> struct min_size_of<type> : std::integral_constant<uint32_t, min_size> {};
ODO_FOR_EACH_MESSAGE(ODO_DETAIL_SIZE)
#undef ODO_DETAIL_SIZE

/// Returns a zeroed message with size, type and time set.
template <class Message> Message make(int64_t t_ns) {
  Message message;
  std::memset(&message, 0, sizeof message);
  message.header.struct_size = sizeof(Message);
  message.header.type = type_of<Message>::value;
  message.header.t_ns = t_ns;
  return message;
}

/// The landmarks of an odo_points: `for (const odo_point& point : odo::Points(message))`. Valid as long as the message;
/// a copy of the struct without the elements behind it has none.
class Points {
 public:
  explicit Points(const odo_points& message) noexcept : message_(&message) {
    while (size_ < message.count && ODO_POINTS_AT(&message, size_)) ++size_;
  }
  uint32_t size() const noexcept { return size_; }
  /// `i` below size().
  const odo_point& operator[](uint32_t i) const noexcept { return *ODO_POINTS_AT(message_, i); }

  class Iterator {
   public:
    Iterator(const Points& points, uint32_t i) noexcept : points_(&points), i_(i) {}
    const odo_point& operator*() const noexcept { return (*points_)[i_]; }
    Iterator& operator++() noexcept { return ++i_, *this; }
    bool operator!=(const Iterator& other) const noexcept { return i_ != other.i_; }

   private:
    const Points* points_;
    uint32_t i_;
  };
  Iterator begin() const noexcept { return {*this, 0}; }
  Iterator end() const noexcept { return {*this, size_}; }

 private:
  const odo_points* message_;
  uint32_t size_ = 0;
};

/// An odo_points with room for ODO_MOST_POINTS elements, for Output::emit(). One allocation, at construction.
class PointsWriter {
 public:
  PointsWriter() : storage_(std::make_unique<Storage>()) {}
  /// Starts the message of a frame, without elements. `metric`: positions in metres, otherwise in units of the group.
  void begin(int64_t t_ns, uint32_t camera, uint32_t scale_group, bool metric) noexcept {
    odo_points& message = storage_->message;
    message = odo_points{};
    message.header.type = ODO_TYPE_POINTS;
    message.header.flags = metric ? ODO_POINTS_METRIC : 0u;
    message.header.t_ns = t_ns;
    message.camera = camera, message.scale_group = scale_group;
    message.stride = sizeof(odo_point), message.offset = offsetof(Storage, points);
    message.header.struct_size = message.offset;
  }
  /// Every landmark counts in `total`; those beyond ODO_MOST_POINTS are not stored: add the most certain first.
  void add(const odo_point& point) noexcept {
    odo_points& message = storage_->message;
    ++message.total;
    if (message.count == ODO_MOST_POINTS) return;
    storage_->points[message.count++] = point;
    message.header.struct_size += message.stride;
  }
  const odo_points& message() const noexcept { return storage_->message; }

 private:
  struct Storage {
    odo_points message;
    odo_point points[ODO_MOST_POINTS];
  };
  std::unique_ptr<Storage> storage_;
};

/// An odo_surface with room for ODO_MOST_VERTICES, for Output::emit().
class SurfaceWriter {
 public:
  /// Starts the message of a surface that is present, without an outline; the caller fills the rest.
  void begin(int64_t t_ns, uint64_t id) noexcept {
    storage_.message = odo_surface{};
    storage_.message.header.type = ODO_TYPE_SURFACE;
    storage_.message.header.t_ns = t_ns;
    storage_.message.id = id, storage_.message.state = ODO_SURFACE_PRESENT;
    storage_.message.stride = sizeof(odo_vertex), storage_.message.offset = offsetof(Storage, vertices);
    storage_.message.header.struct_size = storage_.message.offset;
  }
  /// The next vertex, in the surface's x and y, m, counterclockwise. Those beyond ODO_MOST_VERTICES are not stored.
  void add(float x, float y) noexcept {
    if (storage_.message.count == ODO_MOST_VERTICES) return;
    storage_.vertices[storage_.message.count++] = {{x, y}};
    storage_.message.header.struct_size += storage_.message.stride;
  }
  odo_surface& message() noexcept { return storage_.message; }
  const odo_surface& message() const noexcept { return storage_.message; }

 private:
  struct Storage {
    odo_surface message{};
    odo_vertex vertices[ODO_MOST_VERTICES];
  } storage_{};
};

/// Emits events to the sink and reports to the report service. [process]
class Output {
 public:
  Output() = default;
  Output(const odo_host* host, uint32_t instance) : host_(host), instance_(instance) {
    if (host && host->get_service)
      report_ = static_cast<const odo_report_service*>(
          host->get_service(host, ODO_SERVICE_REPORT, sizeof(ODO_SERVICE_REPORT) - 1));
  }
  void connect(const odo_sink* sink) { sink_ = sink; }

  /// Copies the event to the host. Returns false if the host is older than the event; throws odo::Error if it rejects
  /// it.
  template <class Message> bool emit(Message event) {
    event.header.struct_size = sizeof(Message);
    event.header.type = type_of<Message>::value;
    return emitted(event.header);
  }
  bool emit(const PointsWriter& points) { return emitted(points.message().header); }
  bool emit(const SurfaceWriter& surface) { return emitted(surface.message().header); }
  /// Requests a call of woken(), for plugins with another source of data. Returns false if the host does not provide
  /// the service, for example to a plugin that is isolated in a process. [any]
  bool wake() const noexcept {
    static constexpr std::string_view id = ODO_SERVICE_WAKE;
    const auto* service = static_cast<const odo_wake_service*>(
        host_ && host_->get_service ? host_->get_service(host_, id.data(), id.size()) : nullptr);
    if (!service || !service->wake) return false;
    service->wake(host_, instance_);
    return true;
  }
  void report(uint32_t severity, std::string_view key, std::string_view text) const noexcept {
    const odo_string k = str(key), t = str(text);
    if (report_ && report_->report) report_->report(host_, instance_, severity, &k, &t);
  }
  /// Returns the path of a file that the config names, or null if there is none. [control]
  std::unique_ptr<std::string> asset(std::string_view name) const {
    static constexpr std::string_view id = ODO_SERVICE_ASSETS;
    const void* found = host_ && host_->get_service ? host_->get_service(host_, id.data(), id.size()) : nullptr;
    const auto* assets = static_cast<const odo_asset_service*>(found);
    const odo_string wanted = str(name);
    std::string path(4096, '\0');
    const int64_t size = assets && assets->resolve ? assets->resolve(host_, &wanted, &path[0], path.size()) : -1;
    if (size < 0 || size > static_cast<int64_t>(path.size())) return nullptr;
    path.resize(static_cast<size_t>(size));
    return std::make_unique<std::string>(std::move(path));
  }
  const odo_host* host() const noexcept { return host_; }
  uint32_t instance() const noexcept { return instance_; }

 private:
  bool emitted(const odo_header& event) {
    const int32_t status = sink_ ? sink_->emit(sink_, &event) : ODO_E_STATE;
    if (status < 0 && status != ODO_E_UNSUPPORTED)
      throw Error(status, "the host refused an event of type " + std::to_string(event.type));
    return status >= 0;
  }

  const odo_host* host_ = nullptr;
  uint32_t instance_ = 0;
  const odo_report_service* report_ = nullptr;
  const odo_sink* sink_ = nullptr;
};

/// List of the vendor messages that on() of a plugin receives.
template <class... Own> struct Messages {};

namespace detail {

template <class T, class M, class = void> struct has_on : std::false_type {};
template <class T, class M>
struct has_on<T, M,
              std::void_t<decltype(std::declval<T&>().on(std::declval<const M&>(), std::declval<Output&>()))>>
    : std::true_type {};

template <class T, class = void> struct vendor_messages { using type = Messages<>; };
template <class T> struct vendor_messages<T, std::void_t<typename T::VendorMessages>> {
  using type = typename T::VendorMessages;
};
template <class T, class = void> struct has_extra_inputs : std::false_type {};
template <class T> struct has_extra_inputs<T, std::void_t<decltype(T::extra_inputs)>> : std::true_type {};

/// The types of the messages that on() receives, each once; those in extra_inputs may be vendors'.
template <class T, class... Own> std::vector<uint32_t> inputs_of(Messages<Own...>) {
  std::vector<uint32_t> types;
  const auto add = [&types](uint32_t type) {
    for (const uint32_t known : types)
      if (known == type) return;
    types.push_back(type);
  };
#define ODO_DETAIL_INPUT(number, type, name, min_size) \
  if constexpr (has_on<T, type>::value) add(number);
  ODO_FOR_EACH_MESSAGE(ODO_DETAIL_INPUT)
#undef ODO_DETAIL_INPUT
  (add(type_of<Own>::value), ...);
  if constexpr (has_extra_inputs<T>::value)
    for (const uint32_t type : T::extra_inputs) add(type);
  return types;
}

}  // namespace detail
}  // inline namespace
}  // namespace odo

#endif
