// SPDX-License-Identifier: Apache-2.0
//
// Header-only C++17 wrapper for apps: RAII for sessions and recordings, events by std::function, frames by
// std::shared_ptr without copies. The C headers document the functions.
//
//   odo::Session session(odo::Options().file("walk.yaml"));
//   session.on_event([](const odo::Event& event) { if (const auto pose = event.get<odo_pose>()) draw(*pose); });
//   session.push(odo::make<odo_imu>(t_ns));
//
// Functions that create or query something throw odo::Error on failure. push() returns a status instead, so that sensor
// callbacks need no exception handling.
#ifndef ODOGRAPH_ODOGRAPH_HPP
#define ODOGRAPH_ODOGRAPH_HPP

#include <odograph/anchor.h>
#include <odograph/plugin_messages.hpp>
#include <odograph/recording.h>
#include <odograph/map.h>
#include <odograph/scene.h>

#include <atomic>
#include <exception>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace odo {
inline namespace ODO_DETAIL_VERSION {

/// A zeroed struct with struct_size set, for the library to fill.
template <class Struct> Struct sized() {
  Struct made;
  std::memset(&made, 0, sizeof made);
  *reinterpret_cast<uint32_t*>(&made) = sizeof made;
  return made;
}

/// Throws odo::Error if the status is negative.
inline void check(int32_t status, const odo_error* error = nullptr) {
  if (status < 0) throw Error(status, error && *error->message ? error->message : odo_status_text(status));
}

/// A borrowed message of any type. An event is valid during its call, a recorded message until the next one.
class Event {
 public:
  explicit Event(const odo_header* header) : header_(header) {}
  const odo_header& header() const noexcept { return *header_; }
  /// Returns a copy of the message if it has that type. Elements are not copied: see points(), ODO_VERTEX_AT.
  template <class Message> std::optional<Message> get() const {
    if (header_->type != type_of<Message>::value) return std::nullopt;
    Message message;
    odo_copy(&message, sizeof message, header_);
    return message;
  }
  /// The landmarks of an odo_points, valid as long as the event; null if it has another type.
  std::optional<Points> points() const {
    if (header_->type != ODO_TYPE_POINTS || header_->struct_size < ODO_POINTS_SIZE_MIN) return std::nullopt;
    return Points(*reinterpret_cast<const odo_points*>(header_));
  }

 private:
  const odo_header* header_;
};

/// Options of a session (odo_session_options). Owns its strings.
class Options {
 public:
  Options& file(std::string path) { return config_path_ = std::move(path), *this; }
  Options& text(std::string yaml) { return config_text_ = std::move(yaml), *this; }
  Options& plugins(std::string folders) { return plugin_path_ = std::move(folders), *this; }
  Options& assets(std::string folders) { return asset_path_ = std::move(folders), *this; }
  Options& live(bool on = true) { return run_ = on ? ODO_RUN_LIVE : ODO_RUN_REPLAY, *this; }
  Options& seed(uint64_t number) { return seed_ = number, *this; }
  odo_session_options c() const {
    auto options = sized<odo_session_options>();
    options.run = run_, options.seed = seed_;
    options.config_path = str(config_path_), options.config_text = str(config_text_);
    options.plugin_path = str(plugin_path_), options.asset_path = str(asset_path_);
    return options;
  }

 private:
  std::string config_path_, config_text_, plugin_path_, asset_path_;
  uint32_t run_ = ODO_RUN_REPLAY;
  uint64_t seed_ = 0;
};

/// A session: one pipeline. Movable. Threads as in odograph.h.
class Session {
 public:
  explicit Session(const Options& options) {
    auto error = sized<odo_error>();
    const odo_session_options c = options.c();
    live_ = c.run == ODO_RUN_LIVE;
    odo_session* made = nullptr;
    check(odo_session_create(&c, &made, &error), &error);
    session_.reset(made);
  }
  odo_session* c() const noexcept { return session_.get(); }

  /// Calls `function` with each event of these types, or with all events if none is given. An exception that it throws
  /// is rethrown by the push or flush that called it (replay), or by the next flush (live).
  void on_event(std::function<void(const Event&)> function, std::initializer_list<uint32_t> types = {}) {
    auto listener = std::make_unique<Listener>();
    listener->function = std::move(function);
    const uint32_t count = types.size() == 0 ? ODO_ALL_EVENTS : static_cast<uint32_t>(types.size());
    check(odo_session_set_callback(c(), types.begin(), count, Listener::call, listener.get()));
    listener_ = std::move(listener);
  }

  /// Returns ODO_OK, or the status of a rejected message.
  template <class Message> int32_t push(const Message& message) { return pushed(odo_session_push(c(), &message.header)); }
  int32_t push(const Event& message) { return pushed(odo_session_push(c(), &message.header())); }
  int32_t push_imu(int64_t t_ns, const double (&gyro_b)[3], const double (&accel_b)[3]) {
    return pushed(odo_session_push_imu(c(), t_ns, gyro_b, accel_b));
  }
  /// Pushes a frame whose planes point into `pixels`. The library shares ownership while it needs them and does not
  /// copy.
  int32_t push(odo_frame frame, std::shared_ptr<const void> pixels) {
    auto* owner = new Shared{{1}, std::move(pixels)};
    frame.loan = {owner, Shared::retain, Shared::release, nullptr, 0};
    const int32_t status = odo_session_push(c(), &frame.header);
    Shared::release(owner);
    return pushed(status);
  }
  void flush() {
    check(odo_session_flush(c()));
    rethrow(*listener_);
  }

  /// Empty before the first pose and outside the available times.
  std::optional<odo_pose> pose(int64_t t_ns = ODO_TIME_LATEST, bool smooth = false, uint32_t of = ODO_OF_PIPELINE) const {
    auto pose = sized<odo_pose>();
    const uint32_t world = smooth ? ODO_WORLD_SMOOTH : ODO_WORLD_CORRECTED;
    if (odo_session_get_pose_of(c(), of, world, t_ns, &pose) != ODO_OK) return std::nullopt;
    return pose;
  }
  odo_statistics statistics() const {
    auto statistics = sized<odo_statistics>();
    check(odo_session_get_statistics(c(), &statistics));
    return statistics;
  }
  /// The latest error or warning since the last call; empty if there is none.
  std::string last_error() const {
    auto error = sized<odo_error>();
    check(odo_session_last_error(c(), &error));
    return error.status == ODO_OK ? std::string() : std::string(error.message);
  }

  /// Empty while the position of the phone is unknown (ODO_NOT_READY): try again after the first poses.
  std::optional<uint64_t> try_create_anchor(odo_anchor_place place, std::string_view name = {}) {
    uint64_t id = 0;
    place.struct_size = sizeof place, place.name = str(name);
    const int32_t status = odo_anchor_create(c(), &place, &id);
    check(status);
    return status == ODO_NOT_READY ? std::nullopt : std::optional<uint64_t>(id);
  }
  /// 0, which is no anchor's id, where try_create_anchor() is empty.
  uint64_t create_anchor(const odo_anchor_place& place, std::string_view name = {}) {
    return try_create_anchor(place, name).value_or(0);
  }
  odo_anchor anchor(uint64_t id, uint32_t world = ODO_WORLD_CORRECTED, int64_t t_ns = ODO_TIME_LATEST) const {
    auto anchor = sized<odo_anchor>();
    check(odo_anchor_get(c(), id, world, t_ns, &anchor));
    return anchor;
  }
  std::vector<uint64_t> anchors() const {
    std::vector<uint64_t> ids(static_cast<size_t>(odo_anchor_list(c(), nullptr, 0)));
    const auto count = static_cast<size_t>(odo_anchor_list(c(), ids.data(), ids.size()));
    if (count < ids.size()) ids.resize(count);
    return ids;
  }
  void remove_anchor(uint64_t id) { check(odo_anchor_remove(c(), id)); }

  /// What a ray hits, nearest first, at most `most`. Empty while the position or the scale is unknown. The size of the ray
  /// is set.
  std::vector<odo_hit> hit_test(odo_ray ray, uint32_t most = 8) const {
    ray.struct_size = sizeof ray;
    std::vector<odo_hit> hits(most, sized<odo_hit>());
    uint32_t count = 0;
    check(odo_session_hit_test(c(), &ray, hits.data(), most, &count));
    hits.resize(count);
    return hits;
  }
  /// The place of a hit for create_anchor(), in the world of its ray.
  static odo_anchor_place place_of(const odo_hit& hit, uint32_t world = ODO_WORLD_CORRECTED) {
    auto place = sized<odo_anchor_place>();
    place.kind = ODO_ANCHOR_HIT, place.t_ns = hit.t_ns, place.world = world, place.surface = hit.surface;
    place.sigma_m = hit.sigma_m;
    std::memcpy(place.q, hit.q_n, sizeof place.q), std::memcpy(place.p, hit.p_n, sizeof place.p);
    return place;
  }

  /// Anchors and parameters estimated by plugins, for load() in a later session.
  std::string save() const {
    const int64_t size = odo_session_save(c(), nullptr, 0);
    std::string data(static_cast<size_t>(size < 0 ? 0 : size), '\0');
    if (odo_session_save(c(), &data[0], data.size()) != size) throw Error(ODO_E_ERROR, "the state could not be saved");
    return data;
  }
  /// Maps of the places that this session has seen, with its anchors, for load_map() in a later one (map.h).
  std::string save_map() const {
    std::string data;
    for (int64_t size; (size = odo_map_save(c(), &data[0], data.size())) != static_cast<int64_t>(data.size());) {
      check(static_cast<int32_t>(size < 0 ? size : 0));
      data.resize(static_cast<size_t>(size));
    }
    return data;
  }
  /// Throws if the map is damaged, or of plugins that the session does not have.
  void load_map(std::string_view data) { check(odo_map_load(c(), data.data(), data.size())); }
  /// False if a plugin rejected its part, which last_error() names; the others are restored.
  bool load(std::string_view data) {
    const int32_t status = odo_session_load(c(), data.data(), data.size());
    check(status);
    return status == ODO_OK;
  }

 private:
  struct Listener {
    std::function<void(const Event&)> function;
    std::exception_ptr thrown;
    static void ODO_CALL call(void* user, const odo_header* event) {
      auto* self = static_cast<Listener*>(user);
      try {
        self->function(Event(event));
      } catch (...) {  // must not propagate through the library
        self->thrown = std::current_exception();
      }
    }
  };
  struct Shared {
    std::atomic<int> holds;
    std::shared_ptr<const void> pixels;
    static int32_t ODO_CALL retain(void* owner) { return ++static_cast<Shared*>(owner)->holds, ODO_OK; }
    static void ODO_CALL release(void* owner) {
      auto* self = static_cast<Shared*>(owner);
      if (--self->holds == 0) delete self;
    }
  };
  static void rethrow(Listener& listener) {
    if (listener.thrown) std::rethrow_exception(std::exchange(listener.thrown, nullptr));
  }
  int32_t pushed(int32_t status) {
    if (!live_) rethrow(*listener_);
    return status;
  }
  struct Destroy {
    void operator()(odo_session* session) const { odo_session_destroy(session); }
  };

  std::unique_ptr<Listener> listener_ = std::make_unique<Listener>();
  std::unique_ptr<odo_session, Destroy> session_;  // destroyed before the listener that it calls
  bool live_ = false;
};

/// A recorded message, and for a frame the encoded picture; both valid until the next message.
struct Recorded {
  Event message;
  std::string_view picture;
};

/// A recording, which is read once: for (const odo::Recorded& recorded : odo::Recording("walk.odo")) ...
class Recording {
 public:
  explicit Recording(std::string_view path) {
    auto error = sized<odo_error>();
    const odo_string name = str(path);
    odo_recording* made = nullptr;
    check(odo_recording_open(&name, &made, &error), &error);
    recording_.reset(made);
  }
  /// Records that cannot be read are skipped and counted in loss().
  std::optional<Recorded> next() {
    const odo_header* message = nullptr;
    const void* picture = nullptr;
    uint64_t size = 0;
    int32_t status = ODO_E_DATA;
    while (status == ODO_E_DATA) status = odo_recording_next(recording_.get(), &message, &picture, &size);
    check(status);
    if (status != ODO_OK) return std::nullopt;
    return Recorded{Event(message), {static_cast<const char*>(picture), static_cast<size_t>(size)}};
  }
  /// Describes missing data; empty if the recording is complete.
  std::string loss() const {
    auto loss = sized<odo_error>();
    check(odo_recording_loss(recording_.get(), &loss));
    return loss.message;
  }

  class iterator {
   public:
    iterator() = default;
    explicit iterator(Recording* recording) : recording_(recording) { ++*this; }
    const Recorded& operator*() const { return *current_; }
    const Recorded* operator->() const { return &*current_; }
    iterator& operator++() {
      current_ = recording_->next();
      return *this;
    }
    bool operator!=(const iterator& other) const { return current_.has_value() != other.current_.has_value(); }

   private:
    Recording* recording_ = nullptr;
    std::optional<Recorded> current_;
  };
  iterator begin() { return iterator(this); }
  iterator end() { return iterator(); }

 private:
  struct Close {
    void operator()(odo_recording* recording) const { odo_recording_close(recording); }
  };
  std::unique_ptr<odo_recording, Close> recording_;
};

/// Writes a recording. close() throws if not all data reached the file; the destructor closes without this check.
class Recorder {
 public:
  explicit Recorder(std::string_view path) {
    auto error = sized<odo_error>();
    const odo_string name = str(path);
    odo_recorder* made = nullptr;
    check(odo_recorder_create(&name, &made, &error), &error);
    recorder_.reset(made);
  }
  /// Appends a message, and for a frame its encoded picture.
  template <class Message> void write(const Message& message, std::string_view picture = {}) {
    check(odo_recorder_write(recorder_.get(), &message.header, picture.data(), picture.size()));
  }
  void close() { check(odo_recorder_close(recorder_.release())); }

 private:
  struct Close {
    void operator()(odo_recorder* recorder) const { odo_recorder_close(recorder); }
  };
  std::unique_ptr<odo_recorder, Close> recorder_;
};

}  // inline namespace
}  // namespace odo

#endif
