// SPDX-License-Identifier: Apache-2.0
//
// Messages by value: ownership of frames, sets of types, sizes.
#include "sdk/host/core/event_queue.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("message_copies");

namespace {

std::vector<uint64_t> bytes_of(uint32_t type, size_t size) {
  std::vector<uint64_t> words((size + 7) / 8, 0x0101010101010101u);
  auto& header = *reinterpret_cast<odo_header*>(words.data());
  header = {};
  header.struct_size = static_cast<uint32_t>(size), header.type = type;
  return words;
}
const odo_header& head(const std::vector<uint64_t>& words) {
  return *reinterpret_cast<const odo_header*>(words.data());
}

int releases = 0;

OwnedMessage frame() {
  auto f = make_message<odo_frame>(ODO_TYPE_FRAME, 5);
  f.loan.release = [](void*) { ++releases; };
  return OwnedMessage(f.header);
}

}  // namespace

TEST_CASE("a frame is released once, by its last owner") {
  releases = 0;
  {
    OwnedMessage a = frame(), b = std::move(a);
    CHECK(a.empty());
    CHECK_FALSE(b.empty());
    OwnedMessage c;
    CHECK(c.empty());
    c = std::move(b);
    CHECK(b.empty());  // NOLINT(bugprone-use-after-move): what a move leaves is what is tested
    CHECK(releases == 0);
  }
  CHECK(releases == 1);
  OwnedMessage d = frame();
  d = frame();  // its previous content is released
  CHECK(releases == 2);
  d.release();
  CHECK(d.empty());
  d.release();
  CHECK(releases == 3);
  auto plain = make_message<odo_frame>(ODO_TYPE_FRAME, 5);
  OwnedMessage(plain.header).release();  // has no release function
  CHECK(releases == 3);
}

TEST_CASE("a set of types contains what was added and nothing else, in any range") {
  std::vector<uint32_t> types;
  for (uint32_t i = 1; i < 40; ++i) types.push_back(i), types.push_back(0x1000 + i);
  types.insert(types.end(), {0x1000, 0xFFF, ODO_TYPE_VENDOR(0, 1), ODO_TYPE_VENDOR(1, 0), UINT32_MAX});
  for (const uint32_t one : types) {
    TypeSet set;
    CHECK(set.empty());
    set.add(one), set.add(one);
    CHECK_FALSE(set.empty());
    for (const uint32_t each : types) CHECK(set.has(each) == (each == one));
  }
  TypeSet both;
  both.add(types[3]), both.add(UINT32_MAX);
  CHECK((both.has(types[3]) && both.has(UINT32_MAX)));
  CHECK_FALSE(TypeSet::all().empty());
  for (const uint32_t each : types) CHECK(TypeSet::all().has(each));
}

TEST_CASE("a message of any size from its type's first version up to the largest is kept whole, others are rejected") {
  const auto size = static_cast<size_t>(message_info(ODO_TYPE_MAGNETOMETER)->size);
  for (const size_t good :
       {size_t(ODO_MAGNETOMETER_SIZE_MIN), size, size_t(639), size_t(640), size_t(641), size_t(ODO_LARGEST_MESSAGE)}) {
    CAPTURE(good);
    const auto words = bytes_of(ODO_TYPE_MAGNETOMETER, good);
    AnyMessage any;
    REQUIRE(any.assign(head(words)));
    AnyMessage copy(any), assigned;
    assigned = copy;
    const AnyMessage moved(std::move(copy));
    for (const AnyMessage* each : {static_cast<const AnyMessage*>(&assigned), &moved}) {
      REQUIRE(each->bytes().size() == good);
      CHECK(std::memcmp(each->bytes().data(), words.data(), good) == 0);
    }
    CHECK(any.assign(make_message<odo_imu>(ODO_TYPE_IMU, 1).header));  // a small one in its place
    CHECK(any.bytes().size() == sizeof(odo_imu));
  }
  for (const size_t bad : {size_t(ODO_MAGNETOMETER_SIZE_MIN) - 1, size_t(ODO_LARGEST_MESSAGE) + 1}) {
    const auto words = bytes_of(ODO_TYPE_MAGNETOMETER, bad);
    AnyMessage any(make_message<odo_imu>(ODO_TYPE_IMU, 7).header);
    CHECK_FALSE(any.assign(head(words)));
    CHECK(any.header().type == ODO_TYPE_IMU);  // as it was
  }
  const auto vendor = bytes_of(ODO_TYPE_VENDOR(3, 3), sizeof(odo_header));
  CHECK(AnyMessage().assign(head(vendor)));
  CHECK_FALSE(AnyMessage().assign(head(bytes_of(ODO_TYPE_VENDOR(3, 3), sizeof(odo_header) - 1))));
}

TEST_CASE("large events pass through a queue in order with small ones, sample after sample") {
  EventQueue queue(40);
  const auto large = bytes_of(ODO_TYPE_VENDOR(3, ODO_VENDOR_EVENT | 3), ODO_LARGEST_MESSAGE);
  const AnyMessage big(head(large)), small(make_message<odo_state>(ODO_TYPE_STATE, 5).header);
  for (int sample = 0; sample < 3; ++sample) {
    queue.begin();
    const int count = sample == 1 ? 40 : 3;  // more than keep their memory
    for (int i = 0; i < count; ++i) CHECK(queue.push(i % 2 ? small : big));
    for (int i = 0; i < count; ++i) {
      const AnyMessage& expected = i % 2 ? small : big;
      REQUIRE(queue.front().bytes().size() == expected.bytes().size());
      CHECK(std::memcmp(queue.front().bytes().data(), expected.bytes().data(), expected.bytes().size()) == 0);
      queue.pop();
    }
    CHECK(queue.empty());
  }
  AnyMessage freed(big);
  freed.release_memory();
  CHECK(freed.header().type == 0);
  CHECK(freed.assign(head(large)));
  CHECK(freed.bytes().size() == ODO_LARGEST_MESSAGE);
}

TEST_CASE("types have names, unknown ones their number, and an app may push all but events and 0") {
  CHECK(message_name(ODO_TYPE_IMU) == "imu");
  CHECK(message_name(ODO_TYPE_REPORT) == "report");
  CHECK(message_name(0x2A) == "type 0x2A");
  CHECK_FALSE(message_info(0));
  CHECK_FALSE(is_input(0));
  CHECK(is_input(ODO_TYPE_IMU));
  CHECK(is_input(ODO_TYPE_WAYPOINT));
  CHECK_FALSE(is_input(ODO_TYPE_ATTITUDE));
  CHECK_FALSE(is_input(ODO_TYPE_REPORT));
  CHECK(is_input(ODO_TYPE_VENDOR(1, 1)));
}

TEST_CASE("a queue of events keeps their order and limits those of one sample, however it is emptied") {
  EventQueue queue(3);
  CHECK(queue.limit() == 3);
  const auto event = [](int64_t t_ns) { return AnyMessage(make_message<odo_state>(ODO_TYPE_STATE, t_ns).header); };
  for (int64_t sample = 0; sample < 5; ++sample) {
    queue.begin();
    CHECK(queue.push(event(1)));
    CHECK(queue.push(event(2)));
    REQUIRE_FALSE(queue.empty());
    CHECK(queue.front().header().t_ns == 1);
    queue.pop();
    CHECK(queue.push(event(3)));
    CHECK_FALSE(queue.push(event(4)));  // the queue has space, but the sample's limit is reached
    CHECK(queue.front().header().t_ns == 2);
    queue.pop();
    CHECK(queue.front().header().t_ns == 3);
    queue.pop();
    CHECK(queue.empty());
  }
  queue.begin();
  for (int i = 0; i < 3; ++i) CHECK(queue.push(event(i)));
  queue.begin();  // a new sample; events of the old one still wait
  CHECK_FALSE(queue.push(event(9)));
}
