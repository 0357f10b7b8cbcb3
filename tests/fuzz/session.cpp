// SPDX-License-Identifier: Apache-2.0
//
// Sequences of C API calls on two sessions, with plugins that fail on command: samples of every type are complete,
// their times and numbers arbitrary. The input's second half may run on a second thread.
#include <atomic>
#include <cstring>
#include <thread>
#include <vector>

#include <odograph/anchor.h>

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/session.hpp"
#include "tests/support/obeys.hpp"

namespace {

using fuzz::Bytes;
using odograph::make_message;

constexpr size_t kMaxCalls = 40;
constexpr uint32_t kWidth = 40, kHeight = 32;

const char* const kConfigs[] = {
    "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n"
    "absolute_fixers: [{plugin: fix/gnss}, {plugin: fix/waypoint}, {plugin: fix/barometer}]\n",
    "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: test/echo}\n"
    "scale_source: [{plugin: test/obeys}, {plugin: scale/step_length}]\n",
    "attitude: {plugin: attitude/magyq}\nvo_frontend: {plugin: test/echo}\nscale_source: {plugin: scale/inertial}\n"
    "coupling: {type: paper}\nabsolute_fixers: [{plugin: fix/gnss}]\n",
    "navigation: {origin: {latitude: 47 deg, longitude: 8 deg, height: 400 m}}\nattitude: {plugin: attitude/vqf}\n"
    "step_estimator: {plugin: step/renaudin2012}\nvo_frontend: {plugin: vo/five_point}\n"
    "scale_source: {plugin: test/obeys}\ncoupling: {orientation: gyroscope}\nabsolute_fixers: [{plugin: fix/gnss}]\n",
};

/// State common to all calls of one input.
struct World {
  odo_session* sessions[2] = {};
  std::atomic<int64_t> now_ns{1'000'000'000};
  std::atomic<int> frames_held{0};
  uint8_t kinds = 0;  // of sessions
  bool one_session = false;

  odo_session* session(size_t i) {
    i = one_session ? 0 : i;
    if (!sessions[i])
      sessions[i] = fuzz::open(kConfigs[(kinds >> (2 + 2 * i)) % std::size(kConfigs)],
                               (kinds & 2) != 0 ? ODO_RUN_LIVE : ODO_RUN_REPLAY);
    return sessions[i];
  }
};

/// The calls of one thread.
class Caller {
 public:
  Caller(World& world, Bytes left) : world_(world), left_(left) {}

  void run() {
    for (size_t count = 0; !left_.empty() && count < kMaxCalls; ++count) {
      const auto what = take<uint8_t>();
      which_ = what >> 7;
      session_ = world_.session(which_);
      call(what & 0x7f);
    }
  }

 private:
  template <class T>
  T take() {
    return left_.take<T>();
  }
  /// Near its usual size, or anything.
  double number(double usual) {
    constexpr double kOdd[] = {0, NAN, HUGE_VAL, -HUGE_VAL, 1e300, -1e300, 1e-300, 1e9, -1e9, 1e15, 90, -181};
    const auto byte = take<uint8_t>();
    return byte < 240 ? usual * (byte - 120) / 120.0 : kOdd[byte % std::size(kOdd)];
  }
  void numbers(double* out, size_t count, double usual) {
    for (size_t i = 0; i < count; ++i) out[i] = number(usual);
  }
  void diagonal(double* matrix, size_t rows, double usual) {
    for (size_t i = 0; i < rows; ++i) matrix[i * (rows + 1)] = std::abs(number(usual));
  }
  void rotation(double* q) {
    numbers(q, 4, 1);
    double norm = 0;
    for (int i = 0; i < 4; ++i) norm += q[i] * q[i];
    for (int i = 0; i < 4 && norm > 0; ++i) q[i] /= std::sqrt(norm);
  }
  /// Soon after the last one, slightly off, after a pause or a jump back of up to a century, or anywhere.
  int64_t time() {
    const auto how = take<uint8_t>();
    int64_t step_ns = int64_t(how % 64) * 1'000'000;
    if (how < 192) return world_.now_ns += step_ns;
    if (how < 224) return world_.now_ns + take<int8_t>() * step_ns;
    if (how >= 248) return take<int64_t>();
    step_ns = 1;
    for (int power = how % 19; power > 0; --power) step_ns *= 10;
    const int64_t now_ns = world_.now_ns;
    if (now_ns > INT64_C(4) << 60 || now_ns < -(INT64_C(4) << 60)) step_ns = -now_ns;  // if no later time is possible
    return world_.now_ns += how % 2 ? step_ns : -step_ns / 10;
  }
  template <class Message>
  Message sample(uint32_t type, uint32_t flags) {
    auto message = make_message<Message>(type, time());
    message.header.flags = take<uint8_t>() < 200 ? flags : take<uint32_t>();
    message.header.source = take<uint8_t>() < 200 ? 0 : take<uint8_t>() % 3;
    return message;
  }
  void push(const odo_header& message) { odo_session_push(session_, &message); }

  void walk() {
    double gyro[3], accel[3];
    numbers(gyro, 3, 0.5), numbers(accel, 3, 1);
    const double bounce = number(4);
    const int count = take<uint8_t>() % 32;
    for (int i = 0; i < count; ++i) {
      const double a[3] = {accel[0], 9.8 + bounce * std::sin(0.12 * i), accel[2]};
      odo_session_push_imu(session_, world_.now_ns += 10'000'000, gyro, a);
    }
  }
  void push_gnss() {
    auto m = sample<odo_gnss>(ODO_TYPE_GNSS, ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE);
    m.latitude_rad = 0.82 + number(1e-4), m.longitude_rad = 0.14 + number(1e-4), m.height_m = 400 + number(20);
    diagonal(m.covariance_n, 3, 100), numbers(m.velocity_n, 3, 2), numbers(m.lever_b, 3, 0.1);
    push(m.header);
  }
  void push_field() {
    auto m = sample<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 0);
    numbers(m.field_b, 3, 5e-5);
    push(m.header);
  }
  void push_pressure() {
    auto m = sample<odo_barometer>(ODO_TYPE_BAROMETER, 0);
    m.pressure_pa = 1e5 + number(1e3), m.sigma_pa = number(5);
    push(m.header);
  }
  void push_calibration() {
    auto m = sample<odo_calibration>(ODO_TYPE_CALIBRATION, ODO_CALIBRATION_EXTRINSICS);
    m.model = 1 + take<uint8_t>() % 2;
    m.width = kWidth, m.height = kHeight, m.fx = m.fy = 40 + number(10), m.cx = 20, m.cy = 16;
    rotation(m.q_b_c), numbers(m.p_b_c, 3, 0.1);
    m.time_offset_ns = take<int16_t>() * INT64_C(10'000), m.line_time_ns = take<int16_t>();
    push(m.header);
  }
  void push_frame() {
    static const std::vector<uint8_t> pixels = [] {
      std::vector<uint8_t> random(4 * kWidth * (kHeight + 256));
      uint32_t state = 1;
      for (uint8_t& pixel : random) pixel = static_cast<uint8_t>((state = state * 1664525 + 1013904223) >> 24);
      return random;
    }();
    auto m = sample<odo_frame>(ODO_TYPE_FRAME, 0);
    m.header.flags &= ~ODO_FRAME_MASK;
    m.format = ODO_FORMAT_GREY8, m.width = kWidth, m.height = kHeight;
    m.planes[0] = {pixels.data() + take<uint8_t>() * kWidth, kWidth, 1, 0};
    m.exposure_ns = take<int16_t>() * INT64_C(1000), m.line_time_ns = take<int16_t>();
    const auto loan = take<uint8_t>() % 4;
    if (loan != 0) {
      m.loan.owner = &world_.frames_held;
      m.loan.retain = loan == 1 ? [](void*) -> int32_t { return ODO_E_EXHAUSTED; }
                                : [](void* held) -> int32_t { return ++*static_cast<std::atomic<int>*>(held), ODO_OK; };
      m.loan.release = [](void* held) { --*static_cast<std::atomic<int>*>(held); };
    }
    push(m.header);
  }
  void push_other() {
    switch (take<uint8_t>() % 6) {
      case 0: {
        auto m = sample<odo_waypoint>(ODO_TYPE_WAYPOINT, 0);
        numbers(m.p_n, 3, 100), m.sigma_m = number(1);
        return push(m.header);
      }
      case 1: {
        auto m = sample<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 0);
        numbers(&m.gyro_noise, 4, 1e-3);
        return push(m.header);
      }
      case 2: {
        auto m = sample<odo_earth_field>(ODO_TYPE_EARTH_FIELD, 7);
        numbers(&m.declination_rad, 3, 0.1);
        return push(m.header);
      }
      case 3: {
        auto m = sample<odo_platform_pose>(ODO_TYPE_PLATFORM_POSE, 0);
        rotation(m.q_w), numbers(m.p_w, 3, 10), diagonal(m.covariance, 6, 0.1);
        return push(m.header);
      }
      case 4: {
        auto m = sample<odo_range>(ODO_TYPE_RANGE, ODO_RANGE_TRANSMITTER);
        m.range_m = number(50), m.sigma_m = number(1), numbers(m.p_n, 3, 50);
        return push(m.header);
      }
      default: {
        auto m = sample<odo_system_step>(ODO_TYPE_SYSTEM_STEP, 1);
        m.count = take<uint8_t>(), m.distance_m = number(100);
        return push(m.header);
      }
    }
  }
  /// test/echo emits a motion of the camera.
  void move() {
    struct {
      odo_header outer;
      odo_vo_motion m;
    } told{};
    told.outer = make_message<odo_vo_motion>(ODO_TYPE_VENDOR(0, 1), time()).header;
    told.outer.struct_size = sizeof told;
    told.m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, told.outer.t_ns);
    odo_vo_motion& m = told.m;
    m.header.flags = take<uint8_t>();
    m.t_from_ns = m.header.t_ns - take<uint8_t>() * INT64_C(4'000'000);
    rotation(m.q_c0_c1), numbers(m.p_c0_c1, 3, 0.3), diagonal(m.covariance, 6, 0.01), numbers(m.velocity_c1, 3, 1);
    m.gravity_c1[take<uint8_t>() % 3] = 1;
    m.scale_group = take<uint8_t>() % 3, m.scale_sigma = number(0.1), m.state = take<uint8_t>() % 4;
    push(told.outer);
  }
  /// test/echo emits any bytes of an event.
  void emit() {
    constexpr uint32_t kEvents[] = {ODO_TYPE_ATTITUDE, ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE,
                                    ODO_TYPE_SCALE,    ODO_TYPE_FIX,  ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2)};
    alignas(8) unsigned char bytes[sizeof(odo_header) + 512] = {};
    auto& outer = *reinterpret_cast<odo_header*>(bytes);
    auto& inner = *reinterpret_cast<odo_header*>(bytes + sizeof outer);
    outer.type = ODO_TYPE_VENDOR(0, 1), outer.t_ns = time();
    const uint32_t type = kEvents[take<uint8_t>() % std::size(kEvents)];
    const auto body = left_.take(sizeof(odo_header) + take<uint8_t>());
    std::memcpy(bytes + sizeof outer, body.data(), body.size());
    inner.type = type, inner.t_ns = take<uint8_t>() < 200 ? outer.t_ns : inner.t_ns;
    inner.struct_size = static_cast<uint32_t>(std::max(body.size(), odograph::min_size(type)));
    outer.struct_size = static_cast<uint32_t>(sizeof outer) + inner.struct_size;
    push(outer);
  }
  void order() {
    odograph::Order o = odograph::order(time());
    o.status = -static_cast<int32_t>(take<uint8_t>() % 16);
    o.emits = take<uint8_t>() % 8, o.learn = take<uint8_t>(), o.rounds_up = take<uint8_t>() % 2;
    push(o.header);
  }
  void ask() {
    odo_pose pose{};
    pose.header.struct_size = take<uint8_t>() < 250 ? static_cast<uint32_t>(sizeof pose) : 7;
    const int64_t t_ns = take<uint8_t>() < 128 ? ODO_TIME_LATEST : time();
    if (odo_session_get_pose_of(session_, take<uint8_t>() % 4, take<uint8_t>() % 3, t_ns, &pose) == ODO_OK)
      fuzz::check(pose.header);
    odo_statistics statistics{};
    statistics.struct_size = take<uint8_t>() < 200 ? static_cast<uint32_t>(sizeof statistics) : 4;
    odo_session_get_statistics(session_, &statistics);
    fuzz::require(std::isfinite(statistics.distance_m + statistics.scale_sigma), "statistics are numbers");
    odo_error error{sizeof error, ODO_OK, {}};
    odo_session_last_error(session_, &error);
    double place[3], there[3];
    numbers(place, 3, 1);
    odo_session_to_geodetic(session_, place, there);
    odo_session_from_geodetic(session_, place, there);
  }
  void anchor() {
    odo_anchor_place place{};
    place.struct_size = sizeof place;
    place.kind = take<uint8_t>() % 5, place.t_ns = take<uint8_t>() < 128 ? ODO_TIME_LATEST : time();
    place.world = take<uint8_t>() % 3, place.height_above = take<uint8_t>() % 5;
    rotation(place.q), numbers(place.p, 3, 10);
    place.latitude_rad = 0.82 + number(1e-4), place.longitude_rad = 0.14 + number(1e-4);
    place.height_m = number(500), place.geoid_height_m = number(50), place.sigma_m = number(2);
    place.name = {"anchor", 6};
    uint64_t id = 0, ids[4];
    odo_anchor_create(session_, &place, &id);
    const int64_t count = std::min<int64_t>(odo_anchor_list(session_, ids, 4), 4);
    for (int64_t i = 0; i < count; ++i) {
      odo_anchor found{};
      found.struct_size = sizeof found;
      if (odo_anchor_get(session_, ids[i], take<uint8_t>() % 3, ODO_TIME_LATEST, &found) == ODO_OK)
        fuzz::require(std::isfinite(found.p_n[0] + found.p_view[2] + found.position_sigma_m), "an anchor has numbers");
      if (take<uint8_t>() % 4 == 0) odo_anchor_remove(session_, ids[i]);
    }
  }
  void keep() {
    const int64_t size = odo_session_save(session_, nullptr, 0);
    blob_.resize(static_cast<size_t>(std::max<int64_t>(size, 0)));
    odo_session_save(session_, blob_.data(), blob_.size());
  }
  void restore() {
    if (!blob_.empty() && take<uint8_t>() % 4 == 0) blob_[take<uint16_t>() % blob_.size()] ^= take<uint8_t>();
    odo_session_load(session_, blob_.data(), take<uint8_t>() % 8 ? blob_.size() : take<uint8_t>() % (blob_.size() + 1));
  }
  void listen() {
    const odo_callback callback = [](void* user,
                                     const odo_header* event) {  // calls the API from the callback, which is allowed
      fuzz::check(*event);
      auto* session = static_cast<odo_session*>(user);
      odo_pose pose{};
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(session, event->t_ns, &pose);
      fuzz::require(odo_session_flush(session) == ODO_E_STATE, "a callback does not wait for itself");
    };
    const bool ends = take<uint8_t>() % 4 == 0;
    odo_session_set_callback(session_, nullptr, ends ? 0 : ODO_ALL_EVENTS, ends ? nullptr : callback, session_);
  }
  void destroy() {
    if (world_.one_session) return;  // the other thread calls it
    odo_session_destroy(world_.sessions[which_]);
    world_.sessions[which_] = nullptr;
  }

  void call(uint8_t what) {
    using Call = void (Caller::*)();
    constexpr Call kCalls[] = {&Caller::walk,       &Caller::walk,       &Caller::walk,
                               &Caller::push_gnss,  &Caller::push_field, &Caller::push_pressure,
                               &Caller::push_frame, &Caller::push_frame, &Caller::push_calibration,
                               &Caller::push_other, &Caller::move,       &Caller::move,
                               &Caller::emit,       &Caller::order,      &Caller::ask,
                               &Caller::anchor,     &Caller::keep,       &Caller::restore,
                               &Caller::listen,     &Caller::destroy};
    if (what % 21 == 20)
      odo_session_flush(session_);
    else
      (this->*kCalls[what % 21])();
  }

  World& world_;
  Bytes left_;
  size_t which_ = 0;
  odo_session* session_ = nullptr;
  std::vector<uint8_t> blob_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  World world;
  Bytes left(data, size);
  world.kinds = left.take<uint8_t>();
  world.one_session = (world.kinds & 1) != 0;
  if (world.one_session) {
    world.session(0);
    const auto first = left.take(size / 2), second = left.rest();
    std::thread other([&] { Caller(world, {second.data(), second.size()}).run(); });
    Caller(world, {first.data(), first.size()}).run();
    other.join();
  } else {
    Caller(world, left).run();
  }
  for (odo_session* session : world.sessions) odo_session_destroy(session);
  fuzz::require(world.frames_held == 0, "every frame that was retained has been released");
  return 0;
}
