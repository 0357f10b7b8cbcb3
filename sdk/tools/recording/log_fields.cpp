// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/log_fields.hpp"

#include <cstring>

extern "C" {
#include <libavutil/base64.h>
}
#include <nlohmann/json.hpp>

#include "sdk/tools/recording/log_messages.hpp"
#include "sdk/tools/recording/read_table.hpp"

namespace odograph {
namespace {

constexpr size_t kLongestList = 10'000;  // of numbers, of transforms

int64_t nanoseconds_of(double s, double ns) {
  return static_cast<int64_t>(s) * 1'000'000'000 + static_cast<int64_t>(ns);
}

/// ROS 1's serialisation and CDR, both little-endian; CDR aligns each number to its size, relative to the end of its
/// four-byte header, and terminates strings with a zero.
class BinaryFields : public LogFields {
 public:
  BinaryFields(Bytes bytes, bool cdr, bool with_pixels) : bytes_(bytes), cdr_(cdr), with_pixels_(with_pixels) {
    if (!cdr) return;
    good_ = bytes.size() >= 4 && bytes[0] == 0 && bytes[1] == 1;  // plain, little-endian
    bytes_ = good_ ? bytes.subspan(4) : Bytes();
  }

  void header(LoggedMessage& out) override {
    if (!cdr_) number<uint32_t>();  // seq
    const auto s = number<uint32_t>(), ns = number<uint32_t>();
    out.t_ns = int64_t(s) * 1'000'000'000 + ns;
    out.frame = text("");
  }
  void numbers(const char*, double* out, size_t count) override {
    for (size_t i = 0; i < count; ++i) out[i] = number<double>();
  }
  void optional_numbers(const char* name, double* out, size_t count) override { numbers(name, out, count); }
  std::vector<double> list(const char* name) override {
    const uint32_t count = number<uint32_t>();
    if (count > kLongestList || !good_) {
      good_ = false;
      return {};
    }
    std::vector<double> values(count);
    numbers(name, values.data(), count);
    return values;
  }
  uint8_t byte(const char*) override { return number<uint8_t>(); }
  uint16_t half(const char*) override { return number<uint16_t>(); }
  uint32_t word(const char*) override { return number<uint32_t>(); }
  std::string text(const char*) override {
    const Bytes raw = take(number<uint32_t>());
    std::string out(reinterpret_cast<const char*>(raw.data()), raw.size());
    if (cdr_ && !out.empty()) out.pop_back();
    return out;
  }
  void bytes(const char*, std::vector<unsigned char>& out) override {
    const Bytes raw = take(number<uint32_t>());
    if (with_pixels_) out.assign(raw.begin(), raw.end());
  }
  size_t begin_list(const char*) override {
    const uint32_t count = number<uint32_t>();
    if (count > kLongestList) good_ = false;
    return good_ ? count : 0;
  }
  void item(size_t) override {}

 private:
  template <class Number>
  Number number() {
    if (cdr_ && at_ % sizeof(Number) != 0) take(sizeof(Number) - at_ % sizeof(Number));
    Number value{};
    if (const Bytes raw = take(sizeof value); raw.size() == sizeof value) std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  Bytes take(size_t size) {
    if (!good_ || size > bytes_.size() - at_) {
      good_ = false;
      return {};
    }
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }

  Bytes bytes_;
  bool cdr_, with_pixels_;
  size_t at_ = 0;
};

class JsonFields : public LogFields {
  using Json = nlohmann::json;

 public:
  JsonFields(Bytes bytes, bool with_pixels)
      : whole_(Json::parse(bytes.begin(), bytes.end(), nullptr, false)), at_(&whole_), with_pixels_(with_pixels) {
    good_ = whole_.is_object();
  }

  void header(LoggedMessage& out) override {
    const Json* head = find("header");
    const Json& from = head ? *head : *at_;
    if (!from.is_object() || !(head || from.contains("timestamp") || from.contains("frame_id"))) return fail();
    const Json* time = find(head ? "header/stamp" : "timestamp");
    take_stamp(time ? *time : Json(), out);
    out.frame = text(head ? "header/frame_id" : "frame_id");
  }
  void numbers(const char* name, double* out, size_t count) override {
    if (!read_numbers(find(name), out, count)) fail();
  }
  void optional_numbers(const char* name, double* out, size_t count) override {
    if (const Json* found = find(name)) read_numbers(found, out, count);
  }
  std::vector<double> list(const char* name) override {
    const Json* found = find(name);
    std::vector<double> values(found && found->is_array() && found->size() <= kLongestList ? found->size() : 0);
    if (!values.empty() && !read_numbers(found, values.data(), values.size())) fail();
    return values;
  }
  uint8_t byte(const char* name) override { return static_cast<uint8_t>(whole_number(name)); }
  uint16_t half(const char* name) override { return static_cast<uint16_t>(whole_number(name)); }
  uint32_t word(const char* name) override { return static_cast<uint32_t>(whole_number(name)); }
  std::string text(const char* name) override { return text_of(find(name)); }
  void bytes(const char* name, std::vector<unsigned char>& out) override {
    const Json* found = find(name);
    if (!found || !found->is_string()) return fail();
    const auto& base64 = found->get_ref<const std::string&>();
    if (!with_pixels_) return;
    out.resize(AV_BASE64_DECODE_SIZE(base64.size()));
    const int size = av_base64_decode(out.data(), base64.c_str(), static_cast<int>(out.size()));
    if (size < 0) return fail();
    out.resize(static_cast<size_t>(size));
  }
  size_t begin_list(const char* name) override {
    items_ = find(name);
    if (!items_ || !items_->is_array() || items_->size() > kLongestList) {
      fail();
      return 0;
    }
    return items_->size();
  }
  void item(size_t number) override { at_ = &(*items_)[number]; }

 private:
  void fail() { good_ = false; }
  const Json* find(const char* name) const {
    for (const std::string& path : phone::alternatives(name)) {
      const Json* at = at_;
      for (size_t begin = 0; at && begin <= path.size();) {
        const size_t end = std::min(path.find('/', begin), path.size());
        const std::string key = path.substr(begin, end - begin);
        at = at->is_object() && at->contains(key) ? &(*at)[key] : nullptr;
        begin = end + 1;
      }
      if (at) return at;
    }
    return nullptr;
  }
  static std::string text_of(const Json* value) {
    return value && value->is_string() ? value->get<std::string>() : std::string();
  }
  static bool read_numbers(const Json* from, double* out, size_t count) {
    static constexpr const char* kAxes[] = {"x", "y", "z", "w"};
    for (size_t i = 0; i < count; ++i) {
      const Json* one = from;
      if (from && from->is_array()) one = i < from->size() ? &(*from)[i] : nullptr;
      if (from && from->is_object()) one = i < 4 && from->contains(kAxes[i]) ? &(*from)[kAxes[i]] : nullptr;
      if (!one || !one->is_number()) return false;
      out[i] = one->get<double>();
    }
    return true;
  }
  double whole_number(const char* name) {
    const Json* found = find(name);
    const double value = found && found->is_number() ? found->get<double>() : -1;
    if (value >= 0 && value < 4294967296.0) return value;
    if (found) fail();  // missing: 0
    return 0;
  }
  /// ROS 1, ROS 2 and Foxglove have different names for the parts of a time.
  void take_stamp(const Json& time, LoggedMessage& out) {
    double parts[2]{};
    const char* names[2][3] = {{"sec", "secs", "sec"}, {"nsec", "nsecs", "nanosec"}};
    for (int k = 0; k < 2; ++k)
      for (const char* name : names[k])
        if (time.is_object() && time.contains(name) && time[name].is_number()) parts[k] = time[name].get<double>();
    if (parts[0] >= 0 && parts[0] < 4.6e9 && parts[1] >= 0 && parts[1] < 1e9)
      out.t_ns = nanoseconds_of(parts[0], parts[1]);
  }

  const Json whole_;
  const Json* at_;
  const Json* items_ = nullptr;
  bool with_pixels_;
};

}  // namespace

std::unique_ptr<LogFields> log_fields(const std::string& encoding, Bytes bytes, bool with_pixels) {
  if (encoding == "json") return std::make_unique<JsonFields>(bytes, with_pixels);
  return std::make_unique<BinaryFields>(bytes, encoding == "cdr", with_pixels);
}

}  // namespace odograph
