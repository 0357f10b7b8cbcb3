// SPDX-License-Identifier: Apache-2.0
//
// Rings and intervals of samples; validity of covariances, against eigenvalues; numbers as texts: the fallback
// functions for C++ libraries without std::from_chars and std::to_chars of double, against those of a library that has
// them.
#include <bit>
#include <clocale>
#include <deque>
#include <random>
#include <tuple>

#include <Eigen/Eigenvalues>

#include "sdk/math/timed_ring.hpp"
#include "sdk/host/messages/bounds.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/math/number_text.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/sample_intervals.hpp"
#include "sdk/math/time.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("numbers");

namespace {

/// Like a queue of limited length.
template <class Ring>
void check_newest() {
  Ring ring;
  std::deque<int> queue;
  CHECK(ring.empty());
  for (int i = 0; i < 23; ++i) {
    if (i == 13) ring.clear(), queue.clear();
    ring.push(i);
    queue.push_front(i);
    if (queue.size() > 5) queue.pop_back();
    REQUIRE(ring.size() == queue.size());
    for (size_t k = 0; k < queue.size(); ++k) CHECK(ring.back(k) == queue[k]);
  }
}

}  // namespace

TEST_CASE("a ring keeps the newest values") { check_newest<odograph::Ring<int, 5>>(); }

TEST_CASE("the intervals between samples cover a span once, in order, and gaps and missing ends are reported") {
  struct Sample {
    int64_t t_ns;
  };
  odograph::Ring<Sample, 8> ring;
  struct Part {
    int64_t before, after, t0, t1;
    bool operator==(const Part&) const = default;
  };
  std::vector<Part> parts;
  const auto visit = [&](const Sample& a, const Sample& b, int64_t t0, int64_t t1) {
    parts.push_back({a.t_ns, b.t_ns, t0, t1});
  };
  const auto whole = [&](int64_t from_ns, int64_t to_ns) {
    parts.clear();
    return odograph::for_each_interval(ring, from_ns, to_ns, 15, visit);
  };
  CHECK(!whole(0, 10));
  for (const int64_t t_ns : {100, 110, 120, 150, 160}) ring.push({t_ns});
  CHECK(odograph::count_after(ring, 120) == 2);
  CHECK(odograph::count_after(ring, 99) == 5);
  CHECK(odograph::count_after(ring, 160) == 0);
  CHECK(whole(103, 118));
  CHECK(parts == std::vector<Part>{{100, 110, 103, 110}, {110, 120, 110, 118}});
  CHECK(whole(110, 120));
  CHECK(parts == std::vector<Part>{{110, 120, 110, 120}});
  CHECK(whole(85, 100));  // extrapolated before the oldest and after the newest sample
  CHECK(parts == std::vector<Part>{{100, 100, 85, 100}});
  CHECK(whole(155, 175));
  CHECK(parts == std::vector<Part>{{150, 160, 155, 160}, {160, 160, 160, 175}});
  CHECK(whole(165, 170));
  CHECK(parts == std::vector<Part>{{160, 160, 165, 170}});
  CHECK((!whole(84, 100) && parts.empty()));
  CHECK((!whole(150, 176) && parts.empty()));
  CHECK(!whole(115, 155));  // 120 to 150
  CHECK(parts.size() == 3);
  CHECK(whole(125, 140));  // within that gap, but no longer than a gap may be
  CHECK((whole(130, 130) && parts.empty()));
}

TEST_CASE("pressure and height are inverse to each other and follow the standard atmosphere") {
  const double table[][2] = {{0, 101325}, {1000, 89874.6}, {5000, 54019.9}, {11000, 22632.1}};  // m, Pa (ISO 2533)
  for (const auto& [height_m, pressure_pa] : table) {
    CHECK(odograph::pressure_at_pa(height_m) == doctest::Approx(pressure_pa).epsilon(1e-5));
    CHECK(std::abs(odograph::pressure_height_m(odograph::pressure_at_pa(height_m)) - height_m) < 1e-9);
  }
}

TEST_CASE("nanoseconds are rounded to nearest, and seconds are the inverse") {
  CHECK(odograph::nanoseconds(1.001) == 1'001'000'000);  // truncation would give one less
  CHECK(odograph::nanoseconds(-1.5e-9) == -2);
  CHECK(odograph::seconds(3 * odograph::kSecond_ns + 5 * odograph::kMillisecond_ns) == doctest::Approx(3.005));
}

TEST_CASE("a timed ring finds values by time, and a value of the newest's time replaces it") {
  struct At {
    int64_t t_ns = 0;
    int value = 0;
  };
  odograph::TimedRing<At, 256> ring;
  CHECK(ring.later_than(0) == 0);
  for (int64_t t = 0; t <= 3000; t += 10) ring.push({t, static_cast<int>(t)});
  CHECK(ring.later_than(3000) == 0);
  CHECK(ring.back(ring.later_than(2994)).t_ns == 2990);
  CHECK(ring.back(ring.later_than(450)).t_ns == 450);  // 256 are kept, from 450 on
  CHECK(ring.later_than(449) == ring.size());
  CHECK(odograph::weight_between(At{10}, At{20}, 14) == doctest::Approx(0.4));
  ring.push({2000, 8});  // older: ignored
  ring.push({3000, 7});
  CHECK(ring.size() == 256);
  CHECK(ring.back(0).value == 7);
}

TEST_CASE("valid covariances are accepted up to rounding, and invalid ones are rejected") {
  std::srand(3);
  for (int i = 0; i < 1000; ++i)
    for (const int n : {3, 6}) {
      const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, 1 + i % n);  // of every rank
      const Eigen::VectorXd units = Eigen::VectorXd::Random(n).unaryExpr([](double x) { return std::pow(10, 4 * x); });
      Eigen::MatrixXd C = units.asDiagonal() * (A * A.transpose()) * units.asDiagonal();
      CHECK(bounds::is_covariance(C.data(), static_cast<size_t>(n)));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A * A.transpose());
      const Eigen::VectorXd v = solver.eigenvectors().col(0);
      const Eigen::MatrixXd worse = A * A.transpose() - (solver.eigenvalues()[0] + 0.2) * v * v.transpose();
      C = units.asDiagonal() * worse * units.asDiagonal();
      CHECK_FALSE(bounds::is_covariance(C.data(), static_cast<size_t>(n)));
    }
}

TEST_CASE("a frame has at most 2^24 pixels in any shape") {
  const uint8_t pixel = 0;
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, 1);
  frame.format = ODO_FORMAT_GREY8, frame.planes[0].data = &pixel;
  for (const auto& [width, height, good] : {std::tuple{4096u, 4096u, true},
                                            {16384u, 1024u, true},
                                            {4032u, 3024u, true},
                                            {4097u, 4096u, false},
                                            {16384u, 1025u, false},
                                            {8000u, 6000u, false}}) {
    frame.width = width, frame.height = height;
    CHECK(message_is_good(frame.header) == good);
  }
}

namespace {

/// Bit-identical, or none in both.
bool same(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return std::bit_cast<uint64_t>(*a) == std::bit_cast<uint64_t>(*b) || (std::isnan(*a) && std::isnan(*b));
}

/// The fallback uses the C library, which on Windows (msvcrt) rounds incorrectly beyond 1e260. It is not used there.
#if defined(_WIN32)
constexpr bool kRoundsWrongly = true;
#else
constexpr bool kRoundsWrongly = false;
#endif

void check(double value) {
  INFO(value);
  const std::string text = odograph::number_text(value);
  CHECK(odograph::plain::number_text(value) == text);
  CHECK(same(odograph::plain::parse_number(text), odograph::parse_number(text)));
  CHECK(same(odograph::parse_number(text), value));
}

}  // namespace

TEST_CASE("fallback numbers as texts are the standard library's, bit for bit" * doctest::skip(kRoundsWrongly)) {
  for (int power = -1074; power <= 1023; ++power)
    for (const double next : {0.0, -HUGE_VAL, HUGE_VAL}) {
      const double value = std::ldexp(1.0, power);
      check(next == 0.0 ? value : std::nextafter(value, next));
    }
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) check(std::bit_cast<double>(random()));
  for (int i = 0; i < 20'000; ++i)
    check(std::round(std::ldexp(static_cast<double>(random() >> 11), -53) * 1e7) / std::pow(10.0, random() % 12));
  for (int power = -323; power <= 308; ++power) check(std::pow(10.0, power)), check(-std::pow(10.0, power));
  for (const double value :
       {0.0, -0.0, HUGE_VAL, -HUGE_VAL, 123456.0, 1e5, 1e6, 1e22, 1e23, 5e-324, 1.7976931348623157e308})
    check(value);
}

TEST_CASE("a text that is not a number is rejected by every function") {
  for (const char* text : {"",
                           "-",
                           ".",
                           "-.",
                           "e5",
                           "1e",
                           "1e+",
                           "1e-",
                           "+1",
                           " 1",
                           "1 ",
                           "1,5",
                           "0x10",
                           "1.5.2",
                           "--1",
                           "1e5.0",
                           "1.",
                           ".5",
                           "-.5e1",
                           "1E5",
                           "00012",
                           "1e0000005",
                           "inf",
                           "-inf",
                           "INFINITY",
                           "nan",
                           "-NaN",
                           "infin",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "0e400",
                           "0.0e-999999999999",
                           "1e999999999999",
                           "123456789012345678901234567890",
                           "2.2250738585072011e-308",
                           "9007199254740993",
                           "0.1f"}) {
    INFO(text);
    CHECK(same(odograph::plain::parse_number(text), odograph::parse_number(text)));
  }
  CHECK_FALSE(odograph::parse_number("1,5"));
  CHECK(*odograph::parse_number("-1.5e3") == -1500);
}

TEST_CASE("numbers as texts have a decimal point in every locale") {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8", "C"}) {
    if (!std::setlocale(LC_NUMERIC, name)) continue;
    CHECK(odograph::plain::number_text(-0.125) == "-0.125");
    CHECK(odograph::plain::number_text(1.25e-9) == "1.25e-09");
    CHECK(same(odograph::plain::parse_number("0.125"), 0.125));
  }
  std::setlocale(LC_NUMERIC, before.c_str());
}
