// SPDX-License-Identifier: Apache-2.0
//
// Published data sets of walks without a camera, and figures of an estimate against their truth.
#include <cmath>

#include <doctest/doctest.h>

#include "sdk/tools/evaluation/walk_truth.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "tests/support/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("recording");

TEST_CASE("a RIDI walk has the phone's axes and a truth with north, east and down") {
  const TemporaryFolder folder;
  const std::string head =
      "time_s,gyro_x,gyro_y,gyro_z,acce_x,acce_y,acce_z,magnet_x,magnet_y,magnet_z,pos_x,pos_y,pos_z,ori_w,ori_x,ori_y,"
      "ori_z\n";
  const auto file = write_text(folder / "ann_leg1.csv", head + "1.0,.1,.2,.3,0,0,9.8,20,30,40,1,2,3,1,0,0,0\n" +
                                                            "1.5,.1,.2,.3,0,0,9.8,20,30,40,4,2,3,1,0,0,0\n");
  const auto recording = read_recording(file);
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  CHECK(recording->format == "RIDI");
  REQUIRE(recording->truth.size() == 2);
  CHECK(recording->truth[0].t_ns == 1'000'000'000);
  CHECK((recording->truth[0].p - Eigen::Vector3d(2, 1, -3)).norm() < 1e-12);
  const Eigen::Vector3d up_n = recording->truth[0].q * Eigen::Vector3d::UnitZ();  // the phone is on its back
  CHECK((up_n - Eigen::Vector3d(0, 0, -1)).norm() < 1e-9);
  const WalkerName name = walker_name(*recording);
  CHECK(name.person == "ann");
  CHECK(name.place == "leg");
  const auto broken = read_recording(write_text(folder / "b.csv", head + "x,.1\n"));
  REQUIRE_FALSE(broken.ok());
  CHECK(broken.failure().text.find("b.csv:2") != std::string::npos);
}

TEST_CASE("an IPIN walk has the sensors' clock, positions in metres, and floors") {
  const TemporaryFolder folder;
  const auto recording = read_recording(write_text(folder / "T01_R02.txt",
                                                   "% head\nACCE;10.02;100.0;0;0;9.8;3\nGYRO;10.03;100.0;0;0;0.1;3\n"
                                                   "ACCE;10.2;100.1;0;0;9.8;3\nPRES;10.05;100.0;990.5;3\n"
                                                   "POSI;11;1;49.0;11.0;0;0\nPOSI;21;2;49.0001;11.0;-1;0\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  const auto places = recording->waypoints();
  REQUIRE(places.size() == 2);
  CHECK(places[1].p_n.x() == doctest::Approx(11.12).epsilon(0.001));
  REQUIRE(recording->true_floors.size() == 2);
  CHECK(recording->true_floors[1].floor == -1);
  int64_t last_ns = 0;
  for (const RecordedMessage& m : recording->messages)
    if (m.message.header().type == ODO_TYPE_IMU) last_ns = m.message.header().t_ns;
  CHECK(last_ns == 10'120'000'000);  // by the sensor's clock; the app's was late
}

TEST_CASE("in Oxford's step counter each rise of a switch is a step") {
  const TemporaryFolder folder;
  write_text(folder / "P_Ann_Hard_InHand_1_stepcounter.csv", "0,0,1\n90000000,1,1\n180000000,1,0\n270000000,0,1\n");
  const auto recording =
      read_recording(write_text(folder / "P_Ann_Hard_InHand_1_accelerometer.csv", "0,3,0,0,9.8\n10000000,3,0,0,9.8\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  CHECK(recording->true_steps.size() == 2);
  CHECK(walker_name(*recording).person == "Ann");
}

TEST_CASE("a trundle wheel's distances and empty fields are read") {
  const TemporaryFolder folder;
  const auto recording = read_recording(
      write_text(folder / "walk.csv",
                 "time;m_accG_x;m_accG_y;m_accG_z;m_rotTate_alpha;m_rotTate_beta;m_rotTate_gamma;steps;distance\n"
                 "100;0;0;9.8;90;0;0;;\n116;0;0;9.8;90;0;0;;\n120;;;;;;;;1\n820;;;;;;;;2\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  REQUIRE(recording->true_distances.size() == 2);
  CHECK(recording->true_distances[1].walked_m == 2);
  REQUIRE(recording->messages.size() == 2);
  CHECK(as<odo_imu>(recording->messages[0].message.header()).gyro_b[0] == doctest::Approx(1.5708).epsilon(1e-4));
}

TEST_CASE("a walk's figures are distance, position after alignment, direction and consistency") {
  Recording recording;
  recording.format = "RIDI";
  Trajectory track;
  std::vector<odo_step> steps;
  for (int i = 0; i <= 600; ++i) {  // 1 m/s, a corner after 30 s; the track is rotated, and 10 % too long
    const double s = 0.1 * i, north = std::min(s, 30.0), east = std::max(0.0, s - 30);
    const int64_t t_ns = int64_t{100'000'000} * i;
    recording.truth.push_back({t_ns, Eigen::Quaterniond::Identity(), {north, east, 0}});
    track.push_back({t_ns, Eigen::Quaterniond::Identity(), {-1.1 * east, 1.1 * north, 5}});
    if (i % 5 != 0 || i == 0) continue;
    odo_step step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
    step.t_start_ns = t_ns - 500'000'000, step.t_end_ns = t_ns, step.length_m = 0.55, step.sigma_m = 0.05;
    steps.push_back(step);
  }
  const WalkTruthFigures f = walk_truth_figures(recording, steps, track);
  CHECK(f.estimated_m / f.true_m == doctest::Approx(1.1).epsilon(0.02));
  CHECK(f.position_m > 0.5);
  CHECK(f.position_m < 2);  // from the length alone: the rotation is removed
  CHECK(percentile(f.heading_deg, 0.5) < 3);
  CHECK(percentile(f.normalised_error, 0.5) == doctest::Approx(1).epsilon(0.1));
  CHECK(std::isnan(f.count_percent));
}

TEST_SUITE_END();
