/* SPDX-License-Identifier: Apache-2.0
 *
 * Written by abi/generate.py; do not edit. Including this header verifies at compile time that the
 * compiler uses the layout of the ABI for every struct.
 */
#ifndef ODOGRAPH_LAYOUT_H
#define ODOGRAPH_LAYOUT_H

#include <odograph/base.h>
#include <odograph/events.h>
#include <odograph/samples.h>
#include <odograph/types.h>
#include <odograph/plugin.h>
#include <odograph/absolute_fixer.h>
#include <odograph/odograph.h>
#include <odograph/anchor.h>
#include <odograph/attitude.h>
#include <odograph/map.h>
#include <odograph/recording.h>
#include <odograph/scale_source.h>
#include <odograph/scene.h>
#include <odograph/step_estimator.h>
#include <odograph/surface_finder.h>
#include <odograph/terrain.h>
#include <odograph/vo_frontend.h>

#define ODO_LAYOUT(name, condition) typedef char odo_layout_of_##name[(condition) ? 1 : -1];
/* clang-format off */
ODO_LAYOUT(odo_string, sizeof(odo_string) == 16 && offsetof(odo_string, data) == 0 &&
           offsetof(odo_string, size) == 8)
ODO_LAYOUT(odo_header, sizeof(odo_header) == 32 && offsetof(odo_header, struct_size) == 0 &&
           offsetof(odo_header, type) == 4 && offsetof(odo_header, t_ns) == 8 &&
           offsetof(odo_header, source) == 16 && offsetof(odo_header, flags) == 20 &&
           offsetof(odo_header, quality) == 24 && offsetof(odo_header, reserved) == 28)
ODO_LAYOUT(odo_loan, sizeof(odo_loan) == 40 && offsetof(odo_loan, owner) == 0 && offsetof(odo_loan, retain) == 8 &&
           offsetof(odo_loan, release) == 16 && offsetof(odo_loan, native) == 24 &&
           offsetof(odo_loan, reserved) == 32)
ODO_LAYOUT(odo_borrowed, sizeof(odo_borrowed) == 72 && offsetof(odo_borrowed, header) == 0 &&
           offsetof(odo_borrowed, loan) == 32)
ODO_LAYOUT(odo_attitude, sizeof(odo_attitude) == 160 && offsetof(odo_attitude, header) == 0 &&
           offsetof(odo_attitude, q_n_b) == 32 && offsetof(odo_attitude, covariance_n) == 64 &&
           offsetof(odo_attitude, gyro_bias_b) == 136)
ODO_LAYOUT(odo_step, sizeof(odo_step) == 96 && offsetof(odo_step, header) == 0 &&
           offsetof(odo_step, t_start_ns) == 32 && offsetof(odo_step, t_end_ns) == 40 &&
           offsetof(odo_step, length_m) == 48 && offsetof(odo_step, sigma_m) == 56 &&
           offsetof(odo_step, frequency_hz) == 64 && offsetof(odo_step, heading_rad) == 72 &&
           offsetof(odo_step, mode) == 80 && offsetof(odo_step, index) == 84 &&
           offsetof(odo_step, heading_sigma_rad) == 88)
ODO_LAYOUT(odo_motion_mode, sizeof(odo_motion_mode) == 40 && offsetof(odo_motion_mode, header) == 0 &&
           offsetof(odo_motion_mode, mode) == 32 && offsetof(odo_motion_mode, reserved) == 36)
ODO_LAYOUT(odo_vo_motion, sizeof(odo_vo_motion) == 544 && offsetof(odo_vo_motion, header) == 0 &&
           offsetof(odo_vo_motion, t_from_ns) == 32 && offsetof(odo_vo_motion, q_c0_c1) == 40 &&
           offsetof(odo_vo_motion, p_c0_c1) == 72 && offsetof(odo_vo_motion, covariance) == 96 &&
           offsetof(odo_vo_motion, q_n_c0) == 384 && offsetof(odo_vo_motion, camera) == 416 &&
           offsetof(odo_vo_motion, state) == 420 && offsetof(odo_vo_motion, reason) == 424 &&
           offsetof(odo_vo_motion, scale_group) == 428 && offsetof(odo_vo_motion, tracked) == 432 &&
           offsetof(odo_vo_motion, inliers) == 436 && offsetof(odo_vo_motion, scale_sigma) == 440 &&
           offsetof(odo_vo_motion, velocity_c1) == 448 && offsetof(odo_vo_motion, gravity_c1) == 472 &&
           offsetof(odo_vo_motion, gyro_bias_b) == 496 && offsetof(odo_vo_motion, accel_bias_b) == 520)
ODO_LAYOUT(odo_scale, sizeof(odo_scale) == 80 && offsetof(odo_scale, header) == 0 &&
           offsetof(odo_scale, valid_from_ns) == 32 && offsetof(odo_scale, valid_to_ns) == 40 &&
           offsetof(odo_scale, scale) == 48 && offsetof(odo_scale, sigma) == 56 &&
           offsetof(odo_scale, displacement_m) == 64 && offsetof(odo_scale, scale_group) == 72 &&
           offsetof(odo_scale, reserved) == 76)
ODO_LAYOUT(odo_fix, sizeof(odo_fix) == 440 && offsetof(odo_fix, header) == 0 && offsetof(odo_fix, p_n) == 32 &&
           offsetof(odo_fix, covariance_n) == 56 && offsetof(odo_fix, q_n_b) == 128 &&
           offsetof(odo_fix, orientation_cov_n) == 160 && offsetof(odo_fix, yaw_rad) == 232 &&
           offsetof(odo_fix, yaw_sigma_rad) == 240 && offsetof(odo_fix, latitude_rad) == 248 &&
           offsetof(odo_fix, longitude_rad) == 256 && offsetof(odo_fix, height_m) == 264 &&
           offsetof(odo_fix, integrity) == 272 && offsetof(odo_fix, landmark_n) == 280 &&
           offsetof(odo_fix, slant_distance_m) == 304 && offsetof(odo_fix, lever_b) == 312 &&
           offsetof(odo_fix, yaw_axis_b) == 336 && offsetof(odo_fix, cross_covariance_n) == 360 &&
           offsetof(odo_fix, slant_sigma_m) == 432)
ODO_LAYOUT(odo_relative_pose, sizeof(odo_relative_pose) == 384 && offsetof(odo_relative_pose, header) == 0 &&
           offsetof(odo_relative_pose, t_from_ns) == 32 && offsetof(odo_relative_pose, q_b0_b1) == 40 &&
           offsetof(odo_relative_pose, p_b0_b1) == 72 && offsetof(odo_relative_pose, covariance) == 96)
ODO_LAYOUT(odo_key_frame, sizeof(odo_key_frame) == 104 && offsetof(odo_key_frame, header) == 0 &&
           offsetof(odo_key_frame, id) == 32 && offsetof(odo_key_frame, camera) == 40 &&
           offsetof(odo_key_frame, landmarks) == 44 && offsetof(odo_key_frame, q_n_b) == 48 &&
           offsetof(odo_key_frame, p_n_b) == 80)
ODO_LAYOUT(odo_map_pose, sizeof(odo_map_pose) == 400 && offsetof(odo_map_pose, header) == 0 &&
           offsetof(odo_map_pose, map) == 32 && offsetof(odo_map_pose, q_m_b) == 40 &&
           offsetof(odo_map_pose, p_m_b) == 72 && offsetof(odo_map_pose, covariance) == 96 &&
           offsetof(odo_map_pose, map_sigma_m) == 384 && offsetof(odo_map_pose, map_sigma_rad) == 392)
ODO_LAYOUT(odo_pose, sizeof(odo_pose) == 544 && offsetof(odo_pose, header) == 0 && offsetof(odo_pose, q_n) == 32 &&
           offsetof(odo_pose, p_n) == 64 && offsetof(odo_pose, velocity_n) == 88 &&
           offsetof(odo_pose, covariance) == 112 && offsetof(odo_pose, scale) == 400 &&
           offsetof(odo_pose, scale_sigma) == 408 && offsetof(odo_pose, distance_m) == 416 &&
           offsetof(odo_pose, state) == 424 && offsetof(odo_pose, reason) == 428 &&
           offsetof(odo_pose, angular_velocity) == 432 && offsetof(odo_pose, velocity_covariance) == 456 &&
           offsetof(odo_pose, floor) == 528 && offsetof(odo_pose, reserved) == 532 &&
           offsetof(odo_pose, floor_probability) == 536)
ODO_LAYOUT(odo_state, sizeof(odo_state) == 40 && offsetof(odo_state, header) == 0 &&
           offsetof(odo_state, state) == 32 && offsetof(odo_state, reason) == 36)
ODO_LAYOUT(odo_correction, sizeof(odo_correction) == 96 && offsetof(odo_correction, header) == 0 &&
           offsetof(odo_correction, q_n) == 32 && offsetof(odo_correction, p_n) == 64 &&
           offsetof(odo_correction, reason) == 88 && offsetof(odo_correction, reserved) == 92)
ODO_LAYOUT(odo_refined, sizeof(odo_refined) == 224 && offsetof(odo_refined, header) == 0 &&
           offsetof(odo_refined, camera) == 32 && offsetof(odo_refined, model) == 36 &&
           offsetof(odo_refined, width) == 40 && offsetof(odo_refined, height) == 44 &&
           offsetof(odo_refined, distortion_count) == 48 && offsetof(odo_refined, reserved) == 52 &&
           offsetof(odo_refined, fx) == 56 && offsetof(odo_refined, fy) == 64 && offsetof(odo_refined, cx) == 72 &&
           offsetof(odo_refined, cy) == 80 && offsetof(odo_refined, distortion) == 88 &&
           offsetof(odo_refined, q_b_c) == 152 && offsetof(odo_refined, p_b_c) == 184 &&
           offsetof(odo_refined, time_offset_ns) == 208 && offsetof(odo_refined, line_time_ns) == 216)
ODO_LAYOUT(odo_points, sizeof(odo_points) == 56 && offsetof(odo_points, header) == 0 &&
           offsetof(odo_points, camera) == 32 && offsetof(odo_points, scale_group) == 36 &&
           offsetof(odo_points, count) == 40 && offsetof(odo_points, stride) == 44 &&
           offsetof(odo_points, offset) == 48 && offsetof(odo_points, total) == 52)
ODO_LAYOUT(odo_point, sizeof(odo_point) == 64 && offsetof(odo_point, id) == 0 && offsetof(odo_point, p_c) == 8 &&
           offsetof(odo_point, covariance) == 20 && offsetof(odo_point, pixel) == 44 &&
           offsetof(odo_point, age) == 52 && offsetof(odo_point, flags) == 56 &&
           offsetof(odo_point, reserved) == 60)
ODO_LAYOUT(odo_surface, sizeof(odo_surface) == 144 && offsetof(odo_surface, header) == 0 &&
           offsetof(odo_surface, id) == 32 && offsetof(odo_surface, merged_into) == 40 &&
           offsetof(odo_surface, kind) == 48 && offsetof(odo_surface, state) == 52 &&
           offsetof(odo_surface, count) == 56 && offsetof(odo_surface, stride) == 60 &&
           offsetof(odo_surface, offset) == 64 && offsetof(odo_surface, reserved) == 68 &&
           offsetof(odo_surface, q_n) == 72 && offsetof(odo_surface, p_n) == 104 &&
           offsetof(odo_surface, sigma_m) == 128 && offsetof(odo_surface, tilt_sigma_rad) == 136)
ODO_LAYOUT(odo_vertex, sizeof(odo_vertex) == 8 && offsetof(odo_vertex, p) == 0)
ODO_LAYOUT(odo_report, sizeof(odo_report) == 1200 && offsetof(odo_report, header) == 0 &&
           offsetof(odo_report, count) == 32 && offsetof(odo_report, severity) == 40 &&
           offsetof(odo_report, status) == 44 && offsetof(odo_report, plugin) == 48 &&
           offsetof(odo_report, key) == 112 && offsetof(odo_report, text) == 176)
ODO_LAYOUT(odo_imu, sizeof(odo_imu) == 80 && offsetof(odo_imu, header) == 0 && offsetof(odo_imu, gyro_b) == 32 &&
           offsetof(odo_imu, accel_b) == 56)
ODO_LAYOUT(odo_magnetometer, sizeof(odo_magnetometer) == 64 && offsetof(odo_magnetometer, header) == 0 &&
           offsetof(odo_magnetometer, field_b) == 32 && offsetof(odo_magnetometer, sigma_t) == 56)
ODO_LAYOUT(odo_barometer, sizeof(odo_barometer) == 48 && offsetof(odo_barometer, header) == 0 &&
           offsetof(odo_barometer, pressure_pa) == 32 && offsetof(odo_barometer, sigma_pa) == 40)
ODO_LAYOUT(odo_gnss, sizeof(odo_gnss) == 184 && offsetof(odo_gnss, header) == 0 &&
           offsetof(odo_gnss, latitude_rad) == 32 && offsetof(odo_gnss, longitude_rad) == 40 &&
           offsetof(odo_gnss, height_m) == 48 && offsetof(odo_gnss, covariance_n) == 56 &&
           offsetof(odo_gnss, velocity_n) == 128 && offsetof(odo_gnss, satellites) == 152 &&
           offsetof(odo_gnss, reserved) == 156 && offsetof(odo_gnss, lever_b) == 160)
ODO_LAYOUT(odo_plane, sizeof(odo_plane) == 24 && offsetof(odo_plane, data) == 0 &&
           offsetof(odo_plane, row_stride) == 8 && offsetof(odo_plane, pixel_stride) == 16 &&
           offsetof(odo_plane, rows) == 20)
ODO_LAYOUT(odo_frame, sizeof(odo_frame) == 256 && offsetof(odo_frame, header) == 0 &&
           offsetof(odo_frame, loan) == 32 && offsetof(odo_frame, format) == 72 &&
           offsetof(odo_frame, width) == 76 && offsetof(odo_frame, height) == 80 &&
           offsetof(odo_frame, plane_count) == 84 && offsetof(odo_frame, planes) == 88 &&
           offsetof(odo_frame, mask) == 184 && offsetof(odo_frame, exposure_ns) == 208 &&
           offsetof(odo_frame, line_time_ns) == 216 && offsetof(odo_frame, fx) == 224 &&
           offsetof(odo_frame, fy) == 232 && offsetof(odo_frame, cx) == 240 && offsetof(odo_frame, cy) == 248)
ODO_LAYOUT(odo_calibration, sizeof(odo_calibration) == 216 && offsetof(odo_calibration, header) == 0 &&
           offsetof(odo_calibration, model) == 32 && offsetof(odo_calibration, width) == 36 &&
           offsetof(odo_calibration, height) == 40 && offsetof(odo_calibration, distortion_count) == 44 &&
           offsetof(odo_calibration, fx) == 48 && offsetof(odo_calibration, fy) == 56 &&
           offsetof(odo_calibration, cx) == 64 && offsetof(odo_calibration, cy) == 72 &&
           offsetof(odo_calibration, distortion) == 80 && offsetof(odo_calibration, q_b_c) == 144 &&
           offsetof(odo_calibration, p_b_c) == 176 && offsetof(odo_calibration, time_offset_ns) == 200 &&
           offsetof(odo_calibration, line_time_ns) == 208)
ODO_LAYOUT(odo_imu_noise, sizeof(odo_imu_noise) == 64 && offsetof(odo_imu_noise, header) == 0 &&
           offsetof(odo_imu_noise, gyro_noise) == 32 && offsetof(odo_imu_noise, gyro_walk) == 40 &&
           offsetof(odo_imu_noise, accel_noise) == 48 && offsetof(odo_imu_noise, accel_walk) == 56)
ODO_LAYOUT(odo_waypoint, sizeof(odo_waypoint) == 88 && offsetof(odo_waypoint, header) == 0 &&
           offsetof(odo_waypoint, p_n) == 32 && offsetof(odo_waypoint, sigma_m) == 56 &&
           offsetof(odo_waypoint, lever_b) == 64)
ODO_LAYOUT(odo_earth_field, sizeof(odo_earth_field) == 56 && offsetof(odo_earth_field, header) == 0 &&
           offsetof(odo_earth_field, declination_rad) == 32 && offsetof(odo_earth_field, inclination_rad) == 40 &&
           offsetof(odo_earth_field, intensity_t) == 48)
ODO_LAYOUT(odo_platform_pose, sizeof(odo_platform_pose) == 384 && offsetof(odo_platform_pose, header) == 0 &&
           offsetof(odo_platform_pose, q_w) == 32 && offsetof(odo_platform_pose, p_w) == 64 &&
           offsetof(odo_platform_pose, covariance) == 88 && offsetof(odo_platform_pose, state) == 376 &&
           offsetof(odo_platform_pose, world) == 380)
ODO_LAYOUT(odo_range, sizeof(odo_range) == 112 && offsetof(odo_range, header) == 0 &&
           offsetof(odo_range, transmitter) == 32 && offsetof(odo_range, range_m) == 40 &&
           offsetof(odo_range, sigma_m) == 48 && offsetof(odo_range, p_n) == 56 &&
           offsetof(odo_range, transmitter_sigma_m) == 80 && offsetof(odo_range, lever_b) == 88)
ODO_LAYOUT(odo_system_step, sizeof(odo_system_step) == 48 && offsetof(odo_system_step, header) == 0 &&
           offsetof(odo_system_step, count) == 32 && offsetof(odo_system_step, distance_m) == 40)
ODO_LAYOUT(odo_host, sizeof(odo_host) == 40 && offsetof(odo_host, struct_size) == 0 &&
           offsetof(odo_host, abi_major_min) == 4 && offsetof(odo_host, abi_major_max) == 8 &&
           offsetof(odo_host, abi_minor) == 12 && offsetof(odo_host, version) == 16 &&
           offsetof(odo_host, get_service) == 32)
ODO_LAYOUT(odo_report_service, sizeof(odo_report_service) == 16 && offsetof(odo_report_service, struct_size) == 0 &&
           offsetof(odo_report_service, reserved) == 4 && offsetof(odo_report_service, report) == 8)
ODO_LAYOUT(odo_random_service, sizeof(odo_random_service) == 16 && offsetof(odo_random_service, struct_size) == 0 &&
           offsetof(odo_random_service, reserved) == 4 && offsetof(odo_random_service, seed) == 8)
ODO_LAYOUT(odo_asset_service, sizeof(odo_asset_service) == 16 && offsetof(odo_asset_service, struct_size) == 0 &&
           offsetof(odo_asset_service, reserved) == 4 && offsetof(odo_asset_service, resolve) == 8)
ODO_LAYOUT(odo_content_service, sizeof(odo_content_service) == 40 &&
           offsetof(odo_content_service, struct_size) == 0 && offsetof(odo_content_service, reserved) == 4 &&
           offsetof(odo_content_service, user) == 8 && offsetof(odo_content_service, open) == 16 &&
           offsetof(odo_content_service, read) == 24 && offsetof(odo_content_service, close) == 32)
ODO_LAYOUT(odo_wake_service, sizeof(odo_wake_service) == 16 && offsetof(odo_wake_service, struct_size) == 0 &&
           offsetof(odo_wake_service, reserved) == 4 && offsetof(odo_wake_service, wake) == 8)
ODO_LAYOUT(odo_run_service, sizeof(odo_run_service) == 8 && offsetof(odo_run_service, struct_size) == 0 &&
           offsetof(odo_run_service, is_live) == 4)
ODO_LAYOUT(odo_parameter, sizeof(odo_parameter) == 112 && offsetof(odo_parameter, struct_size) == 0 &&
           offsetof(odo_parameter, type) == 4 && offsetof(odo_parameter, name) == 8 &&
           offsetof(odo_parameter, unit) == 24 && offsetof(odo_parameter, help) == 40 &&
           offsetof(odo_parameter, default_text) == 56 && offsetof(odo_parameter, choices) == 72 &&
           offsetof(odo_parameter, min) == 88 && offsetof(odo_parameter, max) == 96 &&
           offsetof(odo_parameter, count) == 104 && offsetof(odo_parameter, reserved) == 108)
ODO_LAYOUT(odo_value, sizeof(odo_value) == 64 && offsetof(odo_value, struct_size) == 0 &&
           offsetof(odo_value, type) == 4 && offsetof(odo_value, name) == 8 && offsetof(odo_value, text) == 24 &&
           offsetof(odo_value, reals) == 40 && offsetof(odo_value, count) == 48 &&
           offsetof(odo_value, integer) == 56)
ODO_LAYOUT(odo_batch, sizeof(odo_batch) == 16 && offsetof(odo_batch, struct_size) == 0 &&
           offsetof(odo_batch, count) == 4 && offsetof(odo_batch, messages) == 8)
ODO_LAYOUT(odo_sink, sizeof(odo_sink) == 16 && offsetof(odo_sink, struct_size) == 0 &&
           offsetof(odo_sink, instance) == 4 && offsetof(odo_sink, emit) == 8)
ODO_LAYOUT(odo_plugin, sizeof(odo_plugin) == 224 && offsetof(odo_plugin, struct_size) == 0 &&
           offsetof(odo_plugin, abi_major) == 4 && offsetof(odo_plugin, abi_minor) == 8 &&
           offsetof(odo_plugin, interface_count) == 12 && offsetof(odo_plugin, interfaces) == 16 &&
           offsetof(odo_plugin, id) == 24 && offsetof(odo_plugin, version) == 40 &&
           offsetof(odo_plugin, summary) == 56 && offsetof(odo_plugin, refusal) == 72 &&
           offsetof(odo_plugin, parameters) == 88 && offsetof(odo_plugin, parameter_count) == 96 &&
           offsetof(odo_plugin, parameter_stride) == 100 && offsetof(odo_plugin, flags) == 104 &&
           offsetof(odo_plugin, reserved) == 108 && offsetof(odo_plugin, create) == 112 &&
           offsetof(odo_plugin, configure) == 120 && offsetof(odo_plugin, activate) == 128 &&
           offsetof(odo_plugin, process) == 136 && offsetof(odo_plugin, destroy) == 144 &&
           offsetof(odo_plugin, reset) == 152 && offsetof(odo_plugin, save) == 160 &&
           offsetof(odo_plugin, load) == 168 && offsetof(odo_plugin, get_interface) == 176 &&
           offsetof(odo_plugin, inputs) == 184 && offsetof(odo_plugin, outputs) == 192 &&
           offsetof(odo_plugin, input_count) == 200 && offsetof(odo_plugin, output_count) == 204 &&
           offsetof(odo_plugin, save_map) == 208 && offsetof(odo_plugin, load_map) == 216)
ODO_LAYOUT(odo_error, sizeof(odo_error) == 2048 && offsetof(odo_error, struct_size) == 0 &&
           offsetof(odo_error, status) == 4 && offsetof(odo_error, message) == 8)
ODO_LAYOUT(odo_session_options, sizeof(odo_session_options) == 104 &&
           offsetof(odo_session_options, struct_size) == 0 && offsetof(odo_session_options, run) == 4 &&
           offsetof(odo_session_options, config_path) == 8 && offsetof(odo_session_options, config_text) == 24 &&
           offsetof(odo_session_options, plugin_path) == 40 && offsetof(odo_session_options, seed) == 56 &&
           offsetof(odo_session_options, asset_path) == 64 && offsetof(odo_session_options, flags) == 80 &&
           offsetof(odo_session_options, reserved) == 84 && offsetof(odo_session_options, user) == 88 &&
           offsetof(odo_session_options, get_service) == 96)
ODO_LAYOUT(odo_statistics, sizeof(odo_statistics) == 184 && offsetof(odo_statistics, struct_size) == 0 &&
           offsetof(odo_statistics, reserved) == 4 && offsetof(odo_statistics, pushed) == 8 &&
           offsetof(odo_statistics, processed) == 16 && offsetof(odo_statistics, frames) == 24 &&
           offsetof(odo_statistics, steps) == 32 && offsetof(odo_statistics, fixes_accepted) == 40 &&
           offsetof(odo_statistics, fixes_rejected) == 48 && offsetof(odo_statistics, late) == 56 &&
           offsetof(odo_statistics, duplicate) == 64 && offsetof(odo_statistics, invalid) == 72 &&
           offsetof(odo_statistics, overflow) == 80 && offsetof(odo_statistics, gaps) == 88 &&
           offsetof(odo_statistics, plugin_faults) == 96 && offsetof(odo_statistics, tracking_s) == 104 &&
           offsetof(odo_statistics, degraded_s) == 112 && offsetof(odo_statistics, lost_s) == 120 &&
           offsetof(odo_statistics, distance_m) == 128 && offsetof(odo_statistics, wild) == 136 &&
           offsetof(odo_statistics, events_dropped) == 144 && offsetof(odo_statistics, unknown) == 152 &&
           offsetof(odo_statistics, scale_sigma) == 160 && offsetof(odo_statistics, scale_by_inertia) == 168 &&
           offsetof(odo_statistics, scale_by_steps) == 176)
ODO_LAYOUT(odo_anchor_place, sizeof(odo_anchor_place) == 144 && offsetof(odo_anchor_place, struct_size) == 0 &&
           offsetof(odo_anchor_place, kind) == 4 && offsetof(odo_anchor_place, t_ns) == 8 &&
           offsetof(odo_anchor_place, world) == 16 && offsetof(odo_anchor_place, height_above) == 20 &&
           offsetof(odo_anchor_place, q) == 24 && offsetof(odo_anchor_place, p) == 56 &&
           offsetof(odo_anchor_place, latitude_rad) == 80 && offsetof(odo_anchor_place, longitude_rad) == 88 &&
           offsetof(odo_anchor_place, height_m) == 96 && offsetof(odo_anchor_place, geoid_height_m) == 104 &&
           offsetof(odo_anchor_place, sigma_m) == 112 && offsetof(odo_anchor_place, name) == 120 &&
           offsetof(odo_anchor_place, surface) == 136)
ODO_LAYOUT(odo_anchor, sizeof(odo_anchor) == 264 && offsetof(odo_anchor, struct_size) == 0 &&
           offsetof(odo_anchor, kind) == 4 && offsetof(odo_anchor, id) == 8 && offsetof(odo_anchor, t_ns) == 16 &&
           offsetof(odo_anchor, flags) == 24 && offsetof(odo_anchor, state) == 28 &&
           offsetof(odo_anchor, reason) == 32 && offsetof(odo_anchor, reserved) == 36 &&
           offsetof(odo_anchor, q_n) == 40 && offsetof(odo_anchor, p_n) == 72 &&
           offsetof(odo_anchor, q_view) == 96 && offsetof(odo_anchor, p_view) == 128 &&
           offsetof(odo_anchor, position_sigma_m) == 152 && offsetof(odo_anchor, yaw_sigma_rad) == 160 &&
           offsetof(odo_anchor, view_sigma_m) == 168 && offsetof(odo_anchor, latitude_rad) == 176 &&
           offsetof(odo_anchor, longitude_rad) == 184 && offsetof(odo_anchor, height_m) == 192 &&
           offsetof(odo_anchor, name) == 200)
ODO_LAYOUT(odo_map_point, sizeof(odo_map_point) == 48 && offsetof(odo_map_point, struct_size) == 0 &&
           offsetof(odo_map_point, reserved) == 4 && offsetof(odo_map_point, t_ns) == 8 &&
           offsetof(odo_map_point, p_n) == 16 && offsetof(odo_map_point, sigma_m) == 40)
ODO_LAYOUT(odo_ray, sizeof(odo_ray) == 104 && offsetof(odo_ray, struct_size) == 0 && offsetof(odo_ray, kind) == 4 &&
           offsetof(odo_ray, t_ns) == 8 && offsetof(odo_ray, world) == 16 && offsetof(odo_ray, camera) == 20 &&
           offsetof(odo_ray, pixel) == 24 && offsetof(odo_ray, origin) == 40 && offsetof(odo_ray, direction) == 64 &&
           offsetof(odo_ray, max_distance_m) == 88 && offsetof(odo_ray, wanted) == 96 &&
           offsetof(odo_ray, reserved) == 100)
ODO_LAYOUT(odo_hit, sizeof(odo_hit) == 136 && offsetof(odo_hit, struct_size) == 0 && offsetof(odo_hit, what) == 4 &&
           offsetof(odo_hit, surface) == 8 && offsetof(odo_hit, t_ns) == 16 &&
           offsetof(odo_hit, surface_kind) == 24 && offsetof(odo_hit, reserved) == 28 &&
           offsetof(odo_hit, q_n) == 32 && offsetof(odo_hit, p_n) == 64 && offsetof(odo_hit, normal_n) == 88 &&
           offsetof(odo_hit, distance_m) == 112 && offsetof(odo_hit, sigma_m) == 120 &&
           offsetof(odo_hit, scale_sigma) == 128)
ODO_LAYOUT(odo_terrain, sizeof(odo_terrain) == 24 && offsetof(odo_terrain, struct_size) == 0 &&
           offsetof(odo_terrain, reserved) == 4 && offsetof(odo_terrain, user) == 8 &&
           offsetof(odo_terrain, height) == 16)
/* clang-format on */
#undef ODO_LAYOUT

#endif
