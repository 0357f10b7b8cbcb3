// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for plugin authors. A plugin is a class with a description, a parameter table and one
// `on(message, output)` for each message it wants:
//
//   struct Example {
//     double gain = 1.0;  // the initialiser is the parameter's default
//     static constexpr odo::Description description{"scale/example", "1.0.0", "What it does.", ODO_INTERFACE_SCALE_SOURCE};
//     static std::vector<odo::Parameter<Example>> parameters() {
//       return {odo::real("gain", "m", 0.1, 10.0, &Example::gain, "Metres per unit.")};
//     }
//     void on(const odo_vo_motion& motion, odo::Output& output) { ... output.emit(scale); }
//   };
//   ODO_PLUGIN(Example)
//
// Optional members: void configured() or configured(odo::Output&) (throw odo::Error to refuse), void reset(), std::vector<uint8_t> save() const,
// void load(const uint8_t*, size_t), const void* extension(std::string_view id).
// No exception leaves the plugin: each becomes a status code and a report, also when the plugin carries a C++ runtime of
// its own, because the guard is compiled into the plugin.
#ifndef ODOGRAPH_PLUGIN_HPP
#define ODOGRAPH_PLUGIN_HPP

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/plugin.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace odo {

/// Thrown by a plugin to fail with a chosen status. Any other exception becomes ODO_E_ERROR.
class Error : public std::runtime_error {
 public:
  Error(int32_t status, const std::string& text) : std::runtime_error(text), status_(status) {}
  int32_t status() const noexcept { return status_; }

 private:
  int32_t status_;
};

struct Description {
  const char* id;
  const char* version;
  const char* summary;
  const char* interface_id;
};

inline odo_string str(std::string_view text) { return {text.data(), static_cast<uint64_t>(text.size())}; }
inline std::string_view view(const odo_string& text) {
  return text.size == 0 ? std::string_view() : std::string_view(text.data, static_cast<size_t>(text.size));
}

template <class Message> struct type_of;
#define ODO_DETAIL_TYPE(name, number) \
  template <> struct type_of<name> : std::integral_constant<uint32_t, number> {}
ODO_DETAIL_TYPE(odo_imu, ODO_TYPE_IMU);
ODO_DETAIL_TYPE(odo_magnetometer, ODO_TYPE_MAGNETOMETER);
ODO_DETAIL_TYPE(odo_barometer, ODO_TYPE_BAROMETER);
ODO_DETAIL_TYPE(odo_gnss, ODO_TYPE_GNSS);
ODO_DETAIL_TYPE(odo_frame, ODO_TYPE_FRAME);
ODO_DETAIL_TYPE(odo_calibration, ODO_TYPE_CALIBRATION);
ODO_DETAIL_TYPE(odo_imu_noise, ODO_TYPE_IMU_NOISE);
ODO_DETAIL_TYPE(odo_waypoint, ODO_TYPE_WAYPOINT);
ODO_DETAIL_TYPE(odo_attitude, ODO_TYPE_ATTITUDE);
ODO_DETAIL_TYPE(odo_step, ODO_TYPE_STEP);
ODO_DETAIL_TYPE(odo_motion_mode, ODO_TYPE_MOTION_MODE);
ODO_DETAIL_TYPE(odo_vo_motion, ODO_TYPE_VO_MOTION);
ODO_DETAIL_TYPE(odo_scale, ODO_TYPE_SCALE);
ODO_DETAIL_TYPE(odo_fix, ODO_TYPE_FIX);
ODO_DETAIL_TYPE(odo_pose, ODO_TYPE_POSE);
ODO_DETAIL_TYPE(odo_state, ODO_TYPE_STATE);
#undef ODO_DETAIL_TYPE

/// A zeroed message with its size, type and time filled in.
template <class Message> Message make(int64_t t_ns) {
  Message message;
  std::memset(&message, 0, sizeof message);
  message.header.struct_size = sizeof(Message);
  message.header.type = type_of<Message>::value;
  message.header.t_ns = t_ns;
  return message;
}

/// The way out of a plugin: events to the sink, text to the report service. [process]
class Output {
 public:
  Output() = default;
  Output(const odo_host* host, uint32_t instance) : host_(host), instance_(instance) {
    if (host && host->get_service)
      report_ = static_cast<const odo_report_service*>(
          host->get_service(host, ODO_SERVICE_REPORT, sizeof(ODO_SERVICE_REPORT) - 1));
  }
  void connect(const odo_sink* sink) { sink_ = sink; }

  /// Copies the event to the host. Throws odo::Error when the host refuses it.
  template <class Message> void emit(Message event) {
    event.header.struct_size = sizeof(Message);
    event.header.type = type_of<Message>::value;
    const int32_t status = sink_ ? sink_->emit(sink_, &event.header) : ODO_E_STATE;
    if (status < 0) throw Error(status, "the host refused an event of type " + std::to_string(event.header.type));
  }
  void report(uint32_t severity, std::string_view key, std::string_view text) const noexcept {
    const odo_string k = str(key), t = str(text);
    if (report_ && report_->report) report_->report(host_, instance_, severity, &k, &t);
  }
  /// The path of a file that the config names, or null where there is none. [control]
  std::unique_ptr<std::string> asset(std::string_view name) const {
    static const std::string_view id = ODO_SERVICE_ASSETS;
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
  const odo_host* host_ = nullptr;
  uint32_t instance_ = 0;
  const odo_report_service* report_ = nullptr;
  const odo_sink* sink_ = nullptr;
};

/// One parameter: its line of the table and the member it sets. Made by real(), reals(), integer(), boolean(), text(),
/// choice().
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
template <class T, class = void> struct has_extension : std::false_type {};
template <class T>
struct has_extension<T, std::void_t<decltype(std::declval<T&>().extension(std::string_view()))>> : std::true_type {};
template <class T, class M, class = void> struct has_on : std::false_type {};
template <class T, class M>
struct has_on<T, M,
              std::void_t<decltype(std::declval<T&>().on(std::declval<const M&>(), std::declval<Output&>()))>>
    : std::true_type {};

/// The C table of a plugin class, and the guard around each call.
template <class T> class Glue {
 public:
  static int32_t entry(const odo_host* host, odo_plugin* out) noexcept {
    static constexpr char no_version[] = "this plugin speaks ABI 1 only";
    static constexpr char no_memory[] = "the plugin could not build its tables";
    if (!host || !out || out->struct_size < offsetof(odo_plugin, parameters)) return ODO_E_STRUCT_SIZE;
    if (host->abi_major_min > ODO_ABI_MAJOR || host->abi_major_max < ODO_ABI_MAJOR) {
      out->refusal = {no_version, sizeof no_version - 1};
      return ODO_E_VERSION;
    }
    try {
      const odo_plugin& mine = table();
      const uint32_t size = out->struct_size < sizeof mine ? out->struct_size : static_cast<uint32_t>(sizeof mine);
      std::memcpy(static_cast<void*>(out), &mine, size);
      out->struct_size = size;
      return ODO_OK;
    } catch (...) {
      out->refusal = {no_memory, sizeof no_memory - 1};
      return ODO_E_MEMORY;
    }
  }

 private:
  struct Instance {
    Output output;
    std::vector<Parameter<T>> parameters = T::parameters();
    std::vector<std::pair<size_t, odo_value>> values;  // kept so that reset can build the object anew
    std::vector<std::vector<double>> reals;
    std::vector<std::string> texts;
    std::unique_ptr<T> object = std::make_unique<T>();
  };

  static Instance* of(odo_instance* instance) { return reinterpret_cast<Instance*>(instance); }

  template <class Work> static int32_t guarded(const Output* output, Work&& work) noexcept {
    static constexpr char out_of_memory[] = "out of memory";
    static constexpr char unknown[] = "an exception that is not a std::exception";
    try {
      return work();
    } catch (const Error& error) {
      if (output) output->report(ODO_SEVERITY_ERROR, "error", error.what());
      return error.status() < 0 ? error.status() : ODO_E_ERROR;
    } catch (const std::bad_alloc&) {
      if (output) output->report(ODO_SEVERITY_ERROR, "memory", out_of_memory);
      return ODO_E_MEMORY;
    } catch (const std::exception& error) {
      if (output) output->report(ODO_SEVERITY_ERROR, "exception", error.what());
      return ODO_E_ERROR;
    } catch (...) {
      if (output) output->report(ODO_SEVERITY_ERROR, "exception", unknown);
      return ODO_E_ERROR;
    }
  }

  static const odo_plugin& table() {
    struct Table {
      std::vector<Parameter<T>> parameters = T::parameters();
      std::vector<std::string> defaults;
      std::vector<odo_parameter> rows;
      odo_string interface_id = str(T::description.interface_id);
      odo_plugin plugin;
      Table() {
        const T object;
        for (const auto& p : parameters) defaults.push_back(default_text(object, p));
        for (size_t i = 0; i < parameters.size(); ++i) {
          const auto& p = parameters[i];
          rows.push_back({sizeof(odo_parameter), p.type, str(p.name), str(p.unit), str(p.help), str(defaults[i]),
                          str(p.choices), p.min, p.max, p.type == ODO_PARAMETER_REALS ? 3u : 1u, 0u});
        }
        std::memset(&plugin, 0, sizeof plugin);
        plugin.struct_size = sizeof plugin;
        plugin.abi_major = ODO_ABI_MAJOR;
        plugin.abi_minor = ODO_ABI_MINOR;
        plugin.interface_count = 1;
        plugin.interfaces = &interface_id;
        plugin.id = str(T::description.id);
        plugin.version = str(T::description.version);
        plugin.summary = str(T::description.summary);
        plugin.parameters = rows.data();
        plugin.parameter_count = static_cast<uint32_t>(rows.size());
        plugin.parameter_stride = sizeof(odo_parameter);
        plugin.create = create;
        plugin.configure = configure;
        plugin.activate = activate;
        plugin.process = process;
        plugin.reset = reset;
        plugin.save = save;
        plugin.load = load;
        plugin.get_interface = get_interface;
        plugin.destroy = destroy;
      }
    };
    static const Table instance;
    return instance.plugin;
  }

  static int32_t create(const odo_host* host, uint32_t number, const odo_string*, odo_instance** out) noexcept {
    if (!out) return ODO_E_ARGUMENT;
    const Output output(host, number);
    return guarded(&output, [&]() -> int32_t {
      auto instance = std::make_unique<Instance>();
      instance->output = output;
      *out = reinterpret_cast<odo_instance*>(instance.release());
      return ODO_OK;
    });
  }

  static void apply(Instance& instance) {
    for (const auto& stored : instance.values) {
      const odo_value& value = stored.second;
      T& object = *instance.object;
      std::visit(
          [&](auto member) {
            auto& target = object.*member;
            using V = std::decay_t<decltype(target)>;
            if constexpr (std::is_same_v<V, bool>) target = value.integer != 0;
            else if constexpr (std::is_same_v<V, int64_t>) target = value.integer;
            else if constexpr (std::is_same_v<V, double>) target = value.reals[0];
            else if constexpr (std::is_same_v<V, std::string>) target = std::string(view(value.text));
            else for (size_t i = 0; i < target.size(); ++i) target[i] = value.reals[i];
          },
          instance.parameters[stored.first].member);
    }
    if constexpr (has_configured_with_host<T>::value) instance.object->configured(instance.output);
    else if constexpr (has_configured<T>::value) instance.object->configured();
  }

  static int32_t configure(odo_instance* handle, const odo_value* values, uint32_t count, uint32_t stride) noexcept {
    Instance* instance = of(handle);
    return guarded(&instance->output, [&]() -> int32_t {
      instance->values.clear();
      instance->reals.clear();
      instance->texts.clear();
      instance->reals.reserve(count);
      instance->texts.reserve(count);
      for (uint32_t i = 0; i < count; ++i) {
        const auto* value = reinterpret_cast<const odo_value*>(reinterpret_cast<const char*>(values) + size_t(i) * stride);
        for (size_t row = 0; row < instance->parameters.size(); ++row) {
          if (view(value->name) != instance->parameters[row].name) continue;
          odo_value kept = *value;
          instance->reals.emplace_back(value->reals, value->reals + value->count);
          instance->texts.emplace_back(view(value->text));
          kept.reals = instance->reals.back().data();
          kept.text = str(instance->texts.back());
          instance->values.emplace_back(row, kept);
        }
      }
      apply(*instance);
      return ODO_OK;
    });
  }

  static int32_t activate(odo_instance* handle, const odo_sink* sink) noexcept {
    of(handle)->output.connect(sink);
    return ODO_OK;
  }

  template <class Message> static void deliver(Instance& instance, const odo_header* header) {
    if constexpr (has_on<T, Message>::value) {
      if (header->struct_size >= sizeof(Message)) {
        instance.object->on(*reinterpret_cast<const Message*>(header), instance.output);
      } else {  // an older host: the fields it does not know are zero
        Message grown;
        std::memset(&grown, 0, sizeof grown);
        std::memcpy(static_cast<void*>(&grown), header, header->struct_size);
        instance.object->on(grown, instance.output);
      }
    }
  }

  static int32_t process(odo_instance* handle, const odo_batch* batch) noexcept {
    Instance* instance = of(handle);
    return guarded(&instance->output, [&]() -> int32_t {
      for (uint32_t i = 0; i < batch->count; ++i) {
        const odo_header* header = batch->messages[i];
        switch (header->type) {
          case ODO_TYPE_IMU: deliver<odo_imu>(*instance, header); break;
          case ODO_TYPE_MAGNETOMETER: deliver<odo_magnetometer>(*instance, header); break;
          case ODO_TYPE_BAROMETER: deliver<odo_barometer>(*instance, header); break;
          case ODO_TYPE_GNSS: deliver<odo_gnss>(*instance, header); break;
          case ODO_TYPE_FRAME: deliver<odo_frame>(*instance, header); break;
          case ODO_TYPE_CALIBRATION: deliver<odo_calibration>(*instance, header); break;
          case ODO_TYPE_IMU_NOISE: deliver<odo_imu_noise>(*instance, header); break;
          case ODO_TYPE_WAYPOINT: deliver<odo_waypoint>(*instance, header); break;
          case ODO_TYPE_ATTITUDE: deliver<odo_attitude>(*instance, header); break;
          case ODO_TYPE_STEP: deliver<odo_step>(*instance, header); break;
          case ODO_TYPE_MOTION_MODE: deliver<odo_motion_mode>(*instance, header); break;
          case ODO_TYPE_VO_MOTION: deliver<odo_vo_motion>(*instance, header); break;
          case ODO_TYPE_SCALE: deliver<odo_scale>(*instance, header); break;
          case ODO_TYPE_FIX: deliver<odo_fix>(*instance, header); break;
          case ODO_TYPE_POSE: deliver<odo_pose>(*instance, header); break;
          default: break;  // a newer host's message: not for us
        }
      }
      return ODO_OK;
    });
  }

  static int32_t reset(odo_instance* handle) noexcept {
    Instance* instance = of(handle);
    return guarded(&instance->output, [&]() -> int32_t {
      if constexpr (has_reset<T>::value) {
        instance->object->reset();
      } else {
        instance->object = std::make_unique<T>();
        apply(*instance);
      }
      return ODO_OK;
    });
  }

  static int64_t save(odo_instance* handle, void* data, uint64_t capacity) noexcept {
    int64_t needed = 0;
    if constexpr (has_save<T>::value) {
      Instance* instance = of(handle);
      const int32_t status = guarded(&instance->output, [&]() -> int32_t {
        const std::vector<uint8_t> bytes = instance->object->save();
        needed = static_cast<int64_t>(bytes.size());
        if (!bytes.empty() && bytes.size() <= capacity) std::memcpy(data, bytes.data(), bytes.size());
        return ODO_OK;
      });
      if (status < 0) return status;
    } else {
      (void)handle, (void)data, (void)capacity;
    }
    return needed;
  }

  static int32_t load(odo_instance* handle, const void* data, uint64_t size) noexcept {
    if constexpr (has_save<T>::value) {
      Instance* instance = of(handle);
      return guarded(&instance->output, [&]() -> int32_t {
        instance->object->load(static_cast<const uint8_t*>(data), static_cast<size_t>(size));
        return ODO_OK;
      });
    } else {
      (void)handle, (void)data;
      return size == 0 ? ODO_OK : ODO_E_UNSUPPORTED;
    }
  }

  static const void* get_interface(odo_instance* handle, const char* id, uint64_t size) noexcept {
    if constexpr (has_extension<T>::value) {
      const void* found = nullptr;
      guarded(&of(handle)->output, [&]() -> int32_t {
        found = of(handle)->object->extension(std::string_view(id, static_cast<size_t>(size)));
        return ODO_OK;
      });
      return found;
    } else {
      (void)handle, (void)id, (void)size;
      return nullptr;
    }
  }

  static void destroy(odo_instance* handle) noexcept { delete of(handle); }
};

}  // namespace detail
}  // namespace odo

/// Exports the class as this library's plugin. Once in a plugin, at namespace scope.
#define ODO_PLUGIN(Class)                                                              \
  extern "C" ODO_EXPORT int32_t odo_plugin_entry_v1(const odo_host* host, odo_plugin* out) { \
    return odo::detail::Glue<Class>::entry(host, out);                                 \
  }

#endif
