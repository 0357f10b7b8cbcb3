// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for plugin authors, part 3: the plugin class. It has a description, a parameter table and a
// function `on(message, output)` for each message type that it receives:
//
//   namespace {
//   struct Example {
//     double gain = 1.0;  // the initialiser is the parameter's default
//     static constexpr odo::Description description{"scale/example", "1.0.0", "Summary.", ODO_INTERFACE_SCALE_SOURCE};
//     static std::vector<odo::Parameter<Example>> parameters() {
//       return {odo::real("gain", "m", 0.1, 10.0, &Example::gain, "Metres per unit.")};
//     }
//     void on(const odo_vo_motion& motion, odo::Output& output) { ... output.emit(scale); }
//   };
//   }  // namespace
//   ODO_PLUGIN(Example)
//
// Optional members:
//   void configured() or configured(odo::Output&)     after the parameters are set; throws odo::Error to reject them
//   void reset()                                      default: a new object with the same parameters
//   std::vector<uint8_t> save() const, void load(const uint8_t*, size_t), const void* extension(std::string_view id)
//   std::vector<uint8_t> save_map() const, void load_map(const uint8_t*, size_t)     since 1.1
//   void woken(odo::Output&)                          called after Output::wake()
//   static constexpr uint32_t extra_outputs[]                   message types in addition to those of the kind
//   static constexpr uint32_t extra_inputs[]                    message types that on() does not receive by itself
//   using VendorMessages = odo::Messages<acme_wifi, ...>        vendor messages that on() receives
//   static constexpr uint32_t flags                             ODO_PLUGIN_*
// Define the class in an unnamed namespace, so that no symbol clashes with another plugin's; for plugins linked into a
// program this is checked at compile time. No exception leaves the plugin: each becomes a status code and a report. The
// guard is compiled into the plugin, so this also holds if the plugin has another C++ runtime than the host.
#ifndef ODOGRAPH_PLUGIN_HPP
#define ODOGRAPH_PLUGIN_HPP

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/plugin.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/surface_finder.h>
#include <odograph/vo_frontend.h>

#include <odograph/plugin_messages.hpp>
#include <odograph/plugin_parameters.hpp>
#include <odograph/plugin_traits.hpp>

#include <exception>
#include <iterator>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace odo {
inline namespace ODO_DETAIL_VERSION {

struct Description {
  const char* id;
  const char* version;
  const char* summary;
  const char* interface_id;
};

namespace detail {
/// Whether a class is in an unnamed namespace, from its name in the compiler's function signature.
template <class T> constexpr bool is_unnamed() {
#if defined(_MSC_VER)
  return std::string_view(__FUNCSIG__).find("anonymous") != std::string_view::npos;
#else
  return std::string_view(__PRETTY_FUNCTION__).find("anonymous") != std::string_view::npos;
#endif
}

/// The C table of a plugin class, with an exception guard around each call. The tag has internal linkage, so that two
/// plugin classes of the same name instantiate different Glue types.
template <class T, class Tag> class Glue {
#if defined(ODO_STATIC)
  static_assert(is_unnamed<T>(), "the class of a plugin that is linked into a program must be in an unnamed namespace");
#endif

 public:
  static int32_t fill(const odo_host* host, odo_plugin* out) noexcept {
    static constexpr char no_version[] = "the plugin was built for another ABI than the host's";
    static constexpr char no_memory[] = "the plugin could not build its tables";
    if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
    if (!ODO_HOST_FITS(host)) {
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
    std::vector<std::pair<size_t, odo_value>> values;  // for reset, which constructs a new object
    std::vector<std::vector<double>> reals;
    std::vector<std::string> texts;
    std::vector<uint8_t> map;  // being saved or loaded
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
      std::vector<uint32_t> inputs = inputs_of<T>(typename vendor_messages<T>::type());
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
        if constexpr (has_flags<T>::value) plugin.flags = T::flags;
        plugin.flags |= ODO_PLUGIN_INPUTS_WHOLE;
        plugin.inputs = inputs.data();
        plugin.input_count = static_cast<uint32_t>(inputs.size());
        plugin.create = create;
        plugin.configure = configure;
        plugin.activate = activate;
        plugin.process = process;
        plugin.reset = reset;
        plugin.save = save;
        plugin.load = load;
        plugin.get_interface = get_interface;
        if constexpr (has_extra_outputs<T>::value) {
          plugin.outputs = T::extra_outputs;
          plugin.output_count = static_cast<uint32_t>(std::size(T::extra_outputs));
        }
        plugin.destroy = destroy;
        if constexpr (has_save_map<T>::value) plugin.save_map = save_map, plugin.load_map = load_map;
      }
    };
    static const Table instance;
    return instance.plugin;
  }

  static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* kind, odo_instance** out) noexcept {
    if (!out || !kind) return ODO_E_ARGUMENT;
    if (view(*kind) != T::description.interface_id) return ODO_E_UNSUPPORTED;
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

  static int32_t ODO_CALL configure(odo_instance* handle, const odo_value* values, uint32_t count, uint32_t stride) noexcept {
    Instance* instance = of(handle);
    return guarded(&instance->output, [&]() -> int32_t {
      instance->values.clear();
      instance->reals.clear();
      instance->texts.clear();
      instance->reals.reserve(count);
      instance->texts.reserve(count);
      if (stride < ODO_VALUE_SIZE_MIN) return ODO_E_STRUCT_SIZE;
      for (uint32_t i = 0; i < count; ++i) {
        odo_value value{};  // fields that an older host lacks are zero
        std::memcpy(&value, reinterpret_cast<const char*>(values) + size_t(i) * stride,
                    stride < sizeof value ? stride : sizeof value);
        for (size_t row = 0; row < instance->parameters.size(); ++row) {
          if (view(value.name) != instance->parameters[row].name) continue;
          odo_value kept = value;
          instance->reals.emplace_back(value.reals, value.reals + value.count);
          instance->texts.emplace_back(view(value.text));
          kept.reals = instance->reals.back().data();
          kept.text = str(instance->texts.back());
          instance->values.emplace_back(row, kept);
        }
      }
      apply(*instance);
      return ODO_OK;
    });
  }

  static int32_t ODO_CALL activate(odo_instance* handle, const odo_sink* sink) noexcept {
    of(handle)->output.connect(sink);
    return ODO_OK;
  }

  template <class Message> static void deliver(Instance& instance, const odo_header* header) {
    if constexpr (has_on<T, Message>::value) {
      if (header->struct_size >= sizeof(Message)) {
        instance.object->on(*reinterpret_cast<const Message*>(header), instance.output);
      } else if (header->struct_size >= min_size_of<Message>::value) {  // from an older host: missing fields are zero
        Message grown;
        std::memset(&grown, 0, sizeof grown);
        std::memcpy(static_cast<void*>(&grown), header, header->struct_size);
        instance.object->on(grown, instance.output);
      }
    }
  }

  /// Delivers vendor messages; ignores other types, which a newer host may send.
  template <class... Own> static void deliver_vendors(Instance& instance, const odo_header* header, Messages<Own...>) {
    ((header->type == type_of<Own>::value ? deliver<Own>(instance, header) : void()), ...);
    (void)instance, (void)header;
  }

  static void dispatch(Instance& instance, const odo_header* header) {
    switch (header->type) {
#define ODO_DETAIL_DELIVER(number, type, name, min_size) \
  case number: deliver<type>(instance, header); break;
      ODO_FOR_EACH_MESSAGE(ODO_DETAIL_DELIVER)
#undef ODO_DETAIL_DELIVER
      default: deliver_vendors(instance, header, typename vendor_messages<T>::type());
    }
  }

  /// Processes all messages of the batch, even if one is rejected. Returns the lowest status.
  static int32_t ODO_CALL process(odo_instance* handle, const odo_batch* batch) noexcept {
    Instance* instance = of(handle);
    int32_t worst = ODO_OK;
    const auto keep = [&worst](int32_t status) { worst = status < worst ? status : worst; };
    if constexpr (has_woken<T>::value)
      if (batch->count == 0)
        keep(guarded(&instance->output, [&]() -> int32_t { return instance->object->woken(instance->output), ODO_OK; }));
    for (uint32_t i = 0; i < batch->count; ++i)
      keep(guarded(&instance->output, [&]() -> int32_t { return dispatch(*instance, batch->messages[i]), ODO_OK; }));
    return worst;
  }

  static int32_t ODO_CALL reset(odo_instance* handle) noexcept {
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

  static int64_t ODO_CALL save(odo_instance* handle, void* data, uint64_t capacity) noexcept {
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

  static int32_t ODO_CALL load(odo_instance* handle, const void* data, uint64_t size) noexcept {
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

  static int64_t ODO_CALL save_map(odo_instance* handle, uint64_t offset, void* data, uint64_t capacity) noexcept {
    Instance* instance = of(handle);
    int64_t written = 0;
    const int32_t status = guarded(&instance->output, [&]() -> int32_t {
      if constexpr (has_save_map<T>::value)
        if (offset == 0) instance->map = instance->object->save_map();
      const std::vector<uint8_t>& map = instance->map;
      const size_t left = offset < map.size() ? map.size() - static_cast<size_t>(offset) : 0;
      const size_t size = capacity < left ? static_cast<size_t>(capacity) : left;
      if (size > 0) std::memcpy(data, map.data() + offset, size);
      if (left == 0) std::vector<uint8_t>().swap(instance->map);
      written = static_cast<int64_t>(size);
      return ODO_OK;
    });
    return status < 0 ? status : written;
  }

  static int32_t ODO_CALL load_map(odo_instance* handle, uint64_t offset, const void* data, uint64_t size) noexcept {
    Instance* instance = of(handle);
    return guarded(&instance->output, [&]() -> int32_t {
      std::vector<uint8_t>& map = instance->map;
      if (offset == 0) map.clear();
      if (offset != map.size() || size > ODO_LARGEST_PIECE || size > ODO_LARGEST_MAP - offset) return ODO_E_ARGUMENT;
      const auto* bytes = static_cast<const uint8_t*>(data);
      if (size > 0) return map.insert(map.end(), bytes, bytes + size), ODO_OK;
      const std::vector<uint8_t> whole = std::exchange(map, {});
      if constexpr (has_save_map<T>::value) instance->object->load_map(whole.data(), whole.size());
      return ODO_OK;
    });
  }

  static const void* ODO_CALL get_interface(odo_instance* handle, const char* id, uint64_t size) noexcept {
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

  static void ODO_CALL destroy(odo_instance* handle) noexcept { delete of(handle); }
};

}  // namespace detail
}  // inline namespace
}  // namespace odo

/// Exports the class as the plugin of this library. Use it once per library, at namespace scope.
#define ODO_PLUGIN(Class) ODO_PLUGIN_NAMED(Class, ODO_PLUGIN_ENTRY)
/// The same with another name for the entry function, for plugins that are linked into a program.
#define ODO_PLUGIN_NAMED(Class, entry) ODO_DETAIL_PLUGIN(Class, entry)
#define ODO_DETAIL_PLUGIN(Class, entry)                                                   \
  namespace {                                                                             \
  struct entry##_tag;                                                                     \
  }                                                                                       \
  extern "C" ODO_EXPORT int32_t ODO_CALL entry(const odo_host* host, odo_plugin* out) {   \
    return odo::detail::Glue<Class, entry##_tag>::fill(host, out);                        \
  }

#endif
