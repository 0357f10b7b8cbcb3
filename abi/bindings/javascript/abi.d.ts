// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
export const ODO_ABI_MAJOR: 1;
export const ODO_ABI_MINOR: 0;
export const ODO_OK: 0;
export const ODO_NOT_READY: 1;
export const ODO_END: 2;
export const ODO_PARTIAL: 3;
export const ODO_E_ARGUMENT: -1;
export const ODO_E_DISCARD: -2;
export const ODO_E_EXHAUSTED: -3;
export const ODO_E_UNSUPPORTED: -4;
export const ODO_E_STRUCT_SIZE: -5;
export const ODO_E_VERSION: -6;
export const ODO_E_STATE: -7;
export const ODO_E_CONFIG: -8;
export const ODO_E_NOT_FOUND: -9;
export const ODO_E_DATA: -10;
export const ODO_E_IO: -11;
export const ODO_E_MEMORY: -1001;
export const ODO_E_ERROR: -1002;
export const ODO_E_FATAL: -2001;
export const ODO_BORROWED: 2048;
export const ODO_TYPE_IMU: 1;
export const ODO_TYPE_MAGNETOMETER: 2;
export const ODO_TYPE_BAROMETER: 3;
export const ODO_TYPE_GNSS: 4;
export const ODO_TYPE_CALIBRATION: 5;
export const ODO_TYPE_IMU_NOISE: 6;
export const ODO_TYPE_WAYPOINT: 7;
export const ODO_TYPE_EARTH_FIELD: 8;
export const ODO_TYPE_PLATFORM_POSE: 9;
export const ODO_TYPE_RANGE: 10;
export const ODO_TYPE_SYSTEM_STEP: 11;
export const ODO_TYPE_FRAME: 2049;
export const ODO_TYPE_ATTITUDE: 4097;
export const ODO_TYPE_STEP: 4098;
export const ODO_TYPE_MOTION_MODE: 4099;
export const ODO_TYPE_VO_MOTION: 4100;
export const ODO_TYPE_SCALE: 4101;
export const ODO_TYPE_FIX: 4102;
export const ODO_TYPE_POSE: 4103;
export const ODO_TYPE_STATE: 4104;
export const ODO_TYPE_CORRECTION: 4105;
export const ODO_TYPE_REPORT: 4106;
export const ODO_TYPE_REFINED: 4107;
export const ODO_TYPE_RELATIVE_POSE: 4108;
export const ODO_VENDOR_EVENT: 1024;
export const ODO_FLAG_QUALITY: 2147483648;
export const ODO_FLAG_DESCRIPTION: 268435456;
export const ODO_FLAG_HOST_MASK: 251658240;
export const ODO_FLAG_ACCEPTED: 16777216;
export const ODO_FLAG_NAVIGATION: 33554432;
export const ODO_ATTITUDE_MAGNETIC_NORTH: 1;
export const ODO_ATTITUDE_MAG_DISTURBED: 2;
export const ODO_ATTITUDE_REST: 4;
export const ODO_ATTITUDE_TRUE_NORTH: 8;
export const ODO_ATTITUDE_COVARIANCE: 16;
export const ODO_ATTITUDE_GYRO_BIAS: 32;
export const ODO_MODE_UNKNOWN: 0;
export const ODO_MODE_STATIC: 1;
export const ODO_MODE_WALKING_TEXTING: 2;
export const ODO_MODE_WALKING_SWINGING: 3;
export const ODO_MODE_WALKING_POCKET: 4;
export const ODO_MODE_STAIRS: 5;
export const ODO_MODE_RUNNING: 6;
export const ODO_MODE_HANDLING: 7;
export const ODO_STEP_HEADING: 1;
export const ODO_STEP_HEADING_SIGMA: 2;
export const ODO_TRACKING: 1;
export const ODO_DEGRADED: 2;
export const ODO_LOST: 3;
export const ODO_REASON_NONE: 0;
export const ODO_REASON_INITIALISING: 1;
export const ODO_REASON_TOO_DARK: 2;
export const ODO_REASON_TOO_FAST: 3;
export const ODO_REASON_FEW_FEATURES: 4;
export const ODO_REASON_NO_PARALLAX: 5;
export const ODO_REASON_NO_STEPS: 6;
export const ODO_REASON_SENSOR_SILENT: 7;
export const ODO_REASON_PLUGIN_FAILED: 8;
export const ODO_REASON_NO_SCALE: 9;
export const ODO_VO_ROTATION: 1;
export const ODO_VO_TRANSLATION: 2;
export const ODO_VO_COVARIANCE: 4;
export const ODO_VO_METRIC: 8;
export const ODO_VO_INERTIAL: 16;
export const ODO_SCALE_HORIZONTAL: 1;
export const ODO_SCALE_STEADY: 2;
export const ODO_SCALE_NOT_BY_STEPS: 4;
export const ODO_FIX_NORTH: 1;
export const ODO_FIX_EAST: 2;
export const ODO_FIX_DOWN: 4;
export const ODO_FIX_YAW: 8;
export const ODO_FIX_ORIENTATION: 16;
export const ODO_FIX_GEODETIC: 32;
export const ODO_FIX_SLANT: 64;
export const ODO_FIX_COVARIANCE: 128;
export const ODO_FIX_ORIENTATION_COVARIANCE: 256;
export const ODO_FIX_INTEGRITY: 512;
export const ODO_FIX_LEVER: 1024;
export const ODO_FIX_CROSS_COVARIANCE: 2048;
export const ODO_FIX_SLANT_SIGMA: 4096;
export const ODO_RELATIVE_POSE_TRANSLATION: 1;
export const ODO_RELATIVE_POSE_ROTATION: 2;
export const ODO_POSE_ORIENTATION: 1;
export const ODO_POSE_POSITION: 2;
export const ODO_POSE_VELOCITY: 4;
export const ODO_POSE_METRIC: 8;
export const ODO_POSE_CAMERA: 16;
export const ODO_POSE_EXTRAPOLATED: 32;
export const ODO_POSE_ANGULAR_VELOCITY: 64;
export const ODO_POSE_VELOCITY_COVARIANCE: 128;
export const ODO_POSE_COVARIANCE: 256;
export const ODO_POSE_NORTH: 512;
export const ODO_POSE_FLOOR: 1024;
export const ODO_POSE_CARRIED: 2048;
export const ODO_CORRECTION_FIX: 1;
export const ODO_CORRECTION_SCALE: 2;
export const ODO_CORRECTION_RECOVERED: 3;
export const ODO_CORRECTION_RESTART: 4;
export const ODO_REFINED_EXTRINSICS: 1;
export const ODO_REFINED_TIME_OFFSET: 2;
export const ODO_REFINED_LINE_TIME: 4;
export const ODO_SEVERITY_DEBUG: 0;
export const ODO_SEVERITY_INFO: 1;
export const ODO_SEVERITY_WARNING: 2;
export const ODO_SEVERITY_ERROR: 3;
export const ODO_IMU_GYRO: 1;
export const ODO_IMU_ACCEL: 2;
export const ODO_IMU_GYRO_CORRECTED: 4;
export const ODO_IMU_ACCEL_CORRECTED: 8;
export const ODO_MAGNETOMETER_SIGMA: 1;
export const ODO_MAGNETOMETER_CORRECTED: 2;
export const ODO_BAROMETER_SIGMA: 1;
export const ODO_GNSS_POSITION: 1;
export const ODO_GNSS_HEIGHT: 2;
export const ODO_GNSS_COVARIANCE: 4;
export const ODO_GNSS_VELOCITY: 8;
export const ODO_GNSS_LEVER: 16;
export const ODO_FORMAT_GREY8: 1;
export const ODO_FORMAT_NV12: 2;
export const ODO_FORMAT_NV21: 3;
export const ODO_FORMAT_RGB8: 4;
export const ODO_FORMAT_RGBA8: 5;
export const ODO_FORMAT_YUV420: 6;
export const ODO_FORMAT_BGRA8: 7;
export const ODO_FRAME_EXPOSURE: 1;
export const ODO_FRAME_LINE_TIME: 2;
export const ODO_FRAME_MASK: 4;
export const ODO_FRAME_INTRINSICS: 8;
export const ODO_CAMERA_PINHOLE: 1;
export const ODO_CAMERA_KANNALA_BRANDT: 2;
export const ODO_CALIBRATION_EXTRINSICS: 1;
export const ODO_CALIBRATION_TIME_OFFSET: 2;
export const ODO_CALIBRATION_LINE_TIME: 4;
export const ODO_WAYPOINT_VERTICAL: 1;
export const ODO_WAYPOINT_LEVER: 2;
export const ODO_EARTH_FIELD_DECLINATION: 1;
export const ODO_EARTH_FIELD_INCLINATION: 2;
export const ODO_EARTH_FIELD_INTENSITY: 4;
export const ODO_PLATFORM_POSE_CAMERA: 1;
export const ODO_PLATFORM_POSE_COVARIANCE: 2;
export const ODO_RANGE_TRANSMITTER: 1;
export const ODO_RANGE_LEVER: 2;
export const ODO_SYSTEM_STEP_COUNT: 1;
export const ODO_SYSTEM_STEP_DISTANCE: 2;
export const ODO_PARAMETER_BOOL: 1;
export const ODO_PARAMETER_INT: 2;
export const ODO_PARAMETER_REAL: 3;
export const ODO_PARAMETER_STRING: 4;
export const ODO_PARAMETER_CHOICE: 5;
export const ODO_PARAMETER_REALS: 6;
export const ODO_PLUGIN_SEVERAL_CAMERAS: 1;
export const ODO_PLUGIN_NATIVE_FRAMES: 2;
export const ODO_RUN_LIVE: 0;
export const ODO_RUN_REPLAY: 1;
export const ODO_SESSION_CRASH_NOTES: 1;
export const ODO_WORLD_CORRECTED: 0;
export const ODO_WORLD_SMOOTH: 1;
export const ODO_OF_PIPELINE: 0;
export const ODO_OF_BODY: 1;
export const ODO_OF_CAMERA: 2;
export const ODO_ALL_EVENTS: 4294967295;
export const ODO_ANCHOR_POSE: 1;
export const ODO_ANCHOR_VIEW: 2;
export const ODO_ANCHOR_GEODETIC: 3;
export const ODO_HEIGHT_ELLIPSOID: 1;
export const ODO_HEIGHT_GEOID: 2;
export const ODO_HEIGHT_TERRAIN: 3;
export const ODO_ANCHOR_PLACED: 1;
export const ODO_ANCHOR_VIEW_POSE: 2;
export const ODO_ANCHOR_ON_EARTH: 4;
export const ODO_ANCHOR_IN_FRONT: 8;
export const ODO_REASON_NO_FIX: 10;
export const ODO_REASON_NO_GROUND: 11;
export const ODO_REASON_NO_ORIGIN: 12;

/** An address: a number in a browser, a bigint in Node. */
export type Pointer = number | bigint;

export interface Imu {
  type: 'imu';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  gyro_b: number[];
  accel_b: number[];
}

export interface Magnetometer {
  type: 'magnetometer';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  field_b: number[];
  sigma_t: number;
}

export interface Barometer {
  type: 'barometer';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  pressure_pa: number;
  sigma_pa: number;
}

export interface Gnss {
  type: 'gnss';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  latitude_rad: number;
  longitude_rad: number;
  height_m: number;
  covariance_n: number[];
  velocity_n: number[];
  satellites: number;
  lever_b: number[];
}

export interface Calibration {
  type: 'calibration';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  model: number;
  width: number;
  height: number;
  distortion_count: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  distortion: number[];
  q_b_c: number[];
  p_b_c: number[];
  time_offset_ns: bigint;
  line_time_ns: bigint;
}

export interface ImuNoise {
  type: 'imu_noise';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  gyro_noise: number;
  gyro_walk: number;
  accel_noise: number;
  accel_walk: number;
}

export interface Waypoint {
  type: 'waypoint';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  p_n: number[];
  sigma_m: number;
  lever_b: number[];
}

export interface EarthField {
  type: 'earth_field';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  declination_rad: number;
  inclination_rad: number;
  intensity_t: number;
}

export interface PlatformPose {
  type: 'platform_pose';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  q_w: number[];
  p_w: number[];
  covariance: number[];
  state: number;
  world: number;
}

export interface Range {
  type: 'range';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  transmitter: bigint;
  range_m: number;
  sigma_m: number;
  p_n: number[];
  transmitter_sigma_m: number;
  lever_b: number[];
}

export interface SystemStep {
  type: 'system_step';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  count: bigint;
  distance_m: number;
}

export interface Frame {
  type: 'frame';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  loan_owner: Pointer;
  loan_retain: Pointer;
  loan_release: Pointer;
  loan_native: Pointer;
  loan_reserved: bigint;
  format: number;
  width: number;
  height: number;
  plane_count: number;
  planes0_data: Pointer;
  planes0_row_stride: bigint;
  planes0_pixel_stride: number;
  planes0_rows: number;
  planes1_data: Pointer;
  planes1_row_stride: bigint;
  planes1_pixel_stride: number;
  planes1_rows: number;
  planes2_data: Pointer;
  planes2_row_stride: bigint;
  planes2_pixel_stride: number;
  planes2_rows: number;
  planes3_data: Pointer;
  planes3_row_stride: bigint;
  planes3_pixel_stride: number;
  planes3_rows: number;
  mask_data: Pointer;
  mask_row_stride: bigint;
  mask_pixel_stride: number;
  mask_rows: number;
  exposure_ns: bigint;
  line_time_ns: bigint;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

export interface Attitude {
  type: 'attitude';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  q_n_b: number[];
  covariance_n: number[];
  gyro_bias_b: number[];
}

export interface Step {
  type: 'step';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  t_start_ns: bigint;
  t_end_ns: bigint;
  length_m: number;
  sigma_m: number;
  frequency_hz: number;
  heading_rad: number;
  mode: number;
  index: number;
  heading_sigma_rad: number;
}

export interface MotionMode {
  type: 'motion_mode';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  mode: number;
}

export interface VoMotion {
  type: 'vo_motion';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  t_from_ns: bigint;
  q_c0_c1: number[];
  p_c0_c1: number[];
  covariance: number[];
  q_n_c0: number[];
  camera: number;
  state: number;
  reason: number;
  scale_group: number;
  tracked: number;
  inliers: number;
  scale_sigma: number;
  velocity_c1: number[];
  gravity_c1: number[];
  gyro_bias_b: number[];
  accel_bias_b: number[];
}

export interface Scale {
  type: 'scale';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  valid_from_ns: bigint;
  valid_to_ns: bigint;
  scale: number;
  sigma: number;
  displacement_m: number;
  scale_group: number;
}

export interface Fix {
  type: 'fix';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  p_n: number[];
  covariance_n: number[];
  q_n_b: number[];
  orientation_cov_n: number[];
  yaw_rad: number;
  yaw_sigma_rad: number;
  latitude_rad: number;
  longitude_rad: number;
  height_m: number;
  integrity: number;
  landmark_n: number[];
  slant_distance_m: number;
  lever_b: number[];
  yaw_axis_b: number[];
  cross_covariance_n: number[];
  slant_sigma_m: number;
}

export interface Pose {
  type: 'pose';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  q_n: number[];
  p_n: number[];
  velocity_n: number[];
  covariance: number[];
  scale: number;
  scale_sigma: number;
  distance_m: number;
  state: number;
  reason: number;
  angular_velocity: number[];
  velocity_covariance: number[];
  floor: number;
  floor_probability: number;
}

export interface State {
  type: 'state';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  state: number;
  reason: number;
}

export interface Correction {
  type: 'correction';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  q_n: number[];
  p_n: number[];
  reason: number;
}

export interface Report {
  type: 'report';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  count: bigint;
  severity: number;
  status: number;
  plugin: string;
  key: string;
  text: string;
}

export interface Refined {
  type: 'refined';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  camera: number;
  model: number;
  width: number;
  height: number;
  distortion_count: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  distortion: number[];
  q_b_c: number[];
  p_b_c: number[];
  time_offset_ns: bigint;
  line_time_ns: bigint;
}

export interface RelativePose {
  type: 'relative_pose';
  t_ns: bigint;
  source: number;
  flags: number;
  quality: number;
  t_from_ns: bigint;
  q_b0_b1: number[];
  p_b0_b1: number[];
  covariance: number[];
}

export interface Statistics {
  pushed: bigint;
  processed: bigint;
  frames: bigint;
  steps: bigint;
  fixes_accepted: bigint;
  fixes_rejected: bigint;
  late: bigint;
  duplicate: bigint;
  invalid: bigint;
  overflow: bigint;
  gaps: bigint;
  plugin_faults: bigint;
  tracking_s: number;
  degraded_s: number;
  lost_s: number;
  distance_m: number;
  wild: bigint;
  events_dropped: bigint;
  unknown: bigint;
  scale_sigma: number;
  scale_by_inertia: number;
  scale_by_steps: number;
}

export interface AnchorPlace {
  kind: number;
  t_ns: bigint;
  world: number;
  height_above: number;
  q: number[];
  p: number[];
  latitude_rad: number;
  longitude_rad: number;
  height_m: number;
  geoid_height_m: number;
  sigma_m: number;
  name_data: Pointer;
  name_size: bigint;
}

export interface Anchor {
  kind: number;
  id: bigint;
  t_ns: bigint;
  flags: number;
  state: number;
  reason: number;
  q_n: number[];
  p_n: number[];
  q_view: number[];
  p_view: number[];
  position_sigma_m: number;
  yaw_sigma_rad: number;
  view_sigma_m: number;
  latitude_rad: number;
  longitude_rad: number;
  height_m: number;
  name: string;
}

export type Input = Imu | Magnetometer | Barometer | Gnss | Calibration | ImuNoise | Waypoint | EarthField | PlatformPose | Range | SystemStep | Frame;
export type Event = Attitude | Step | MotionMode | VoMotion | Scale | Fix | Pose | State | Correction | Report | Refined | RelativePose;
export type Message = Input | Event;
export type MessageName = Message['type'];
export const TYPES: Record<MessageName, number>;
export const STRUCTS: Record<string, {size: number; fields: Record<string, [string, number, number?]>}>;
