// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
export const ODO_ABI_MAJOR = 1;
export const ODO_ABI_MINOR = 0;
export const ODO_OK = 0;
export const ODO_NOT_READY = 1;
export const ODO_END = 2;
export const ODO_PARTIAL = 3;
export const ODO_E_ARGUMENT = -1;
export const ODO_E_DISCARD = -2;
export const ODO_E_EXHAUSTED = -3;
export const ODO_E_UNSUPPORTED = -4;
export const ODO_E_STRUCT_SIZE = -5;
export const ODO_E_VERSION = -6;
export const ODO_E_STATE = -7;
export const ODO_E_CONFIG = -8;
export const ODO_E_NOT_FOUND = -9;
export const ODO_E_DATA = -10;
export const ODO_E_IO = -11;
export const ODO_E_MEMORY = -1001;
export const ODO_E_ERROR = -1002;
export const ODO_E_FATAL = -2001;
export const ODO_BORROWED = 2048;
export const ODO_TYPE_IMU = 1;
export const ODO_TYPE_MAGNETOMETER = 2;
export const ODO_TYPE_BAROMETER = 3;
export const ODO_TYPE_GNSS = 4;
export const ODO_TYPE_CALIBRATION = 5;
export const ODO_TYPE_IMU_NOISE = 6;
export const ODO_TYPE_WAYPOINT = 7;
export const ODO_TYPE_EARTH_FIELD = 8;
export const ODO_TYPE_PLATFORM_POSE = 9;
export const ODO_TYPE_RANGE = 10;
export const ODO_TYPE_SYSTEM_STEP = 11;
export const ODO_TYPE_FRAME = 2049;
export const ODO_TYPE_ATTITUDE = 4097;
export const ODO_TYPE_STEP = 4098;
export const ODO_TYPE_MOTION_MODE = 4099;
export const ODO_TYPE_VO_MOTION = 4100;
export const ODO_TYPE_SCALE = 4101;
export const ODO_TYPE_FIX = 4102;
export const ODO_TYPE_POSE = 4103;
export const ODO_TYPE_STATE = 4104;
export const ODO_TYPE_CORRECTION = 4105;
export const ODO_TYPE_REPORT = 4106;
export const ODO_TYPE_REFINED = 4107;
export const ODO_TYPE_RELATIVE_POSE = 4108;
export const ODO_VENDOR_EVENT = 1024;
export const ODO_FLAG_QUALITY = 2147483648;
export const ODO_FLAG_DESCRIPTION = 268435456;
export const ODO_FLAG_HOST_MASK = 251658240;
export const ODO_FLAG_ACCEPTED = 16777216;
export const ODO_FLAG_NAVIGATION = 33554432;
export const ODO_ATTITUDE_MAGNETIC_NORTH = 1;
export const ODO_ATTITUDE_MAG_DISTURBED = 2;
export const ODO_ATTITUDE_REST = 4;
export const ODO_ATTITUDE_TRUE_NORTH = 8;
export const ODO_ATTITUDE_COVARIANCE = 16;
export const ODO_ATTITUDE_GYRO_BIAS = 32;
export const ODO_MODE_UNKNOWN = 0;
export const ODO_MODE_STATIC = 1;
export const ODO_MODE_WALKING_TEXTING = 2;
export const ODO_MODE_WALKING_SWINGING = 3;
export const ODO_MODE_WALKING_POCKET = 4;
export const ODO_MODE_STAIRS = 5;
export const ODO_MODE_RUNNING = 6;
export const ODO_MODE_HANDLING = 7;
export const ODO_STEP_HEADING = 1;
export const ODO_STEP_HEADING_SIGMA = 2;
export const ODO_TRACKING = 1;
export const ODO_DEGRADED = 2;
export const ODO_LOST = 3;
export const ODO_REASON_NONE = 0;
export const ODO_REASON_INITIALISING = 1;
export const ODO_REASON_TOO_DARK = 2;
export const ODO_REASON_TOO_FAST = 3;
export const ODO_REASON_FEW_FEATURES = 4;
export const ODO_REASON_NO_PARALLAX = 5;
export const ODO_REASON_NO_STEPS = 6;
export const ODO_REASON_SENSOR_SILENT = 7;
export const ODO_REASON_PLUGIN_FAILED = 8;
export const ODO_REASON_NO_SCALE = 9;
export const ODO_VO_ROTATION = 1;
export const ODO_VO_TRANSLATION = 2;
export const ODO_VO_COVARIANCE = 4;
export const ODO_VO_METRIC = 8;
export const ODO_VO_INERTIAL = 16;
export const ODO_SCALE_HORIZONTAL = 1;
export const ODO_SCALE_STEADY = 2;
export const ODO_SCALE_NOT_BY_STEPS = 4;
export const ODO_FIX_NORTH = 1;
export const ODO_FIX_EAST = 2;
export const ODO_FIX_DOWN = 4;
export const ODO_FIX_YAW = 8;
export const ODO_FIX_ORIENTATION = 16;
export const ODO_FIX_GEODETIC = 32;
export const ODO_FIX_SLANT = 64;
export const ODO_FIX_COVARIANCE = 128;
export const ODO_FIX_ORIENTATION_COVARIANCE = 256;
export const ODO_FIX_INTEGRITY = 512;
export const ODO_FIX_LEVER = 1024;
export const ODO_FIX_CROSS_COVARIANCE = 2048;
export const ODO_FIX_SLANT_SIGMA = 4096;
export const ODO_RELATIVE_POSE_TRANSLATION = 1;
export const ODO_RELATIVE_POSE_ROTATION = 2;
export const ODO_POSE_ORIENTATION = 1;
export const ODO_POSE_POSITION = 2;
export const ODO_POSE_VELOCITY = 4;
export const ODO_POSE_METRIC = 8;
export const ODO_POSE_CAMERA = 16;
export const ODO_POSE_EXTRAPOLATED = 32;
export const ODO_POSE_ANGULAR_VELOCITY = 64;
export const ODO_POSE_VELOCITY_COVARIANCE = 128;
export const ODO_POSE_COVARIANCE = 256;
export const ODO_POSE_NORTH = 512;
export const ODO_POSE_FLOOR = 1024;
export const ODO_POSE_CARRIED = 2048;
export const ODO_CORRECTION_FIX = 1;
export const ODO_CORRECTION_SCALE = 2;
export const ODO_CORRECTION_RECOVERED = 3;
export const ODO_CORRECTION_RESTART = 4;
export const ODO_REFINED_EXTRINSICS = 1;
export const ODO_REFINED_TIME_OFFSET = 2;
export const ODO_REFINED_LINE_TIME = 4;
export const ODO_SEVERITY_DEBUG = 0;
export const ODO_SEVERITY_INFO = 1;
export const ODO_SEVERITY_WARNING = 2;
export const ODO_SEVERITY_ERROR = 3;
export const ODO_IMU_GYRO = 1;
export const ODO_IMU_ACCEL = 2;
export const ODO_IMU_GYRO_CORRECTED = 4;
export const ODO_IMU_ACCEL_CORRECTED = 8;
export const ODO_MAGNETOMETER_SIGMA = 1;
export const ODO_MAGNETOMETER_CORRECTED = 2;
export const ODO_BAROMETER_SIGMA = 1;
export const ODO_GNSS_POSITION = 1;
export const ODO_GNSS_HEIGHT = 2;
export const ODO_GNSS_COVARIANCE = 4;
export const ODO_GNSS_VELOCITY = 8;
export const ODO_GNSS_LEVER = 16;
export const ODO_FORMAT_GREY8 = 1;
export const ODO_FORMAT_NV12 = 2;
export const ODO_FORMAT_NV21 = 3;
export const ODO_FORMAT_RGB8 = 4;
export const ODO_FORMAT_RGBA8 = 5;
export const ODO_FORMAT_YUV420 = 6;
export const ODO_FORMAT_BGRA8 = 7;
export const ODO_FRAME_EXPOSURE = 1;
export const ODO_FRAME_LINE_TIME = 2;
export const ODO_FRAME_MASK = 4;
export const ODO_FRAME_INTRINSICS = 8;
export const ODO_CAMERA_PINHOLE = 1;
export const ODO_CAMERA_KANNALA_BRANDT = 2;
export const ODO_CALIBRATION_EXTRINSICS = 1;
export const ODO_CALIBRATION_TIME_OFFSET = 2;
export const ODO_CALIBRATION_LINE_TIME = 4;
export const ODO_WAYPOINT_VERTICAL = 1;
export const ODO_WAYPOINT_LEVER = 2;
export const ODO_EARTH_FIELD_DECLINATION = 1;
export const ODO_EARTH_FIELD_INCLINATION = 2;
export const ODO_EARTH_FIELD_INTENSITY = 4;
export const ODO_PLATFORM_POSE_CAMERA = 1;
export const ODO_PLATFORM_POSE_COVARIANCE = 2;
export const ODO_RANGE_TRANSMITTER = 1;
export const ODO_RANGE_LEVER = 2;
export const ODO_SYSTEM_STEP_COUNT = 1;
export const ODO_SYSTEM_STEP_DISTANCE = 2;
export const ODO_PARAMETER_BOOL = 1;
export const ODO_PARAMETER_INT = 2;
export const ODO_PARAMETER_REAL = 3;
export const ODO_PARAMETER_STRING = 4;
export const ODO_PARAMETER_CHOICE = 5;
export const ODO_PARAMETER_REALS = 6;
export const ODO_PLUGIN_SEVERAL_CAMERAS = 1;
export const ODO_PLUGIN_NATIVE_FRAMES = 2;
export const ODO_RUN_LIVE = 0;
export const ODO_RUN_REPLAY = 1;
export const ODO_SESSION_CRASH_NOTES = 1;
export const ODO_WORLD_CORRECTED = 0;
export const ODO_WORLD_SMOOTH = 1;
export const ODO_OF_PIPELINE = 0;
export const ODO_OF_BODY = 1;
export const ODO_OF_CAMERA = 2;
export const ODO_ALL_EVENTS = 4294967295;
export const ODO_ANCHOR_POSE = 1;
export const ODO_ANCHOR_VIEW = 2;
export const ODO_ANCHOR_GEODETIC = 3;
export const ODO_HEIGHT_ELLIPSOID = 1;
export const ODO_HEIGHT_GEOID = 2;
export const ODO_HEIGHT_TERRAIN = 3;
export const ODO_ANCHOR_PLACED = 1;
export const ODO_ANCHOR_VIEW_POSE = 2;
export const ODO_ANCHOR_ON_EARTH = 4;
export const ODO_ANCHOR_IN_FRONT = 8;
export const ODO_REASON_NO_FIX = 10;
export const ODO_REASON_NO_GROUND = 11;
export const ODO_REASON_NO_ORIGIN = 12;

// Type numbers of the messages.
export const TYPES = {
  imu: 0x1,
  magnetometer: 0x2,
  barometer: 0x3,
  gnss: 0x4,
  calibration: 0x5,
  imu_noise: 0x6,
  waypoint: 0x7,
  earth_field: 0x8,
  platform_pose: 0x9,
  range: 0xa,
  system_step: 0xb,
  frame: 0x801,
  attitude: 0x1001,
  step: 0x1002,
  motion_mode: 0x1003,
  vo_motion: 0x1004,
  scale: 0x1005,
  fix: 0x1006,
  pose: 0x1007,
  state: 0x1008,
  correction: 0x1009,
  report: 0x100a,
  refined: 0x100b,
  relative_pose: 0x100c,
};

// Size of each struct in bytes; type, offset and count of each field.
export const STRUCTS = {
  imu: {size: 80, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    gyro_b: ['f64', 32, 3],
    accel_b: ['f64', 56, 3],
  }},
  magnetometer: {size: 64, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    field_b: ['f64', 32, 3],
    sigma_t: ['f64', 56],
  }},
  barometer: {size: 48, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    pressure_pa: ['f64', 32],
    sigma_pa: ['f64', 40],
  }},
  gnss: {size: 184, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    latitude_rad: ['f64', 32],
    longitude_rad: ['f64', 40],
    height_m: ['f64', 48],
    covariance_n: ['f64', 56, 9],
    velocity_n: ['f64', 128, 3],
    satellites: ['u32', 152],
    lever_b: ['f64', 160, 3],
  }},
  calibration: {size: 216, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    model: ['u32', 32],
    width: ['u32', 36],
    height: ['u32', 40],
    distortion_count: ['u32', 44],
    fx: ['f64', 48],
    fy: ['f64', 56],
    cx: ['f64', 64],
    cy: ['f64', 72],
    distortion: ['f64', 80, 8],
    q_b_c: ['f64', 144, 4],
    p_b_c: ['f64', 176, 3],
    time_offset_ns: ['i64', 200],
    line_time_ns: ['i64', 208],
  }},
  imu_noise: {size: 64, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    gyro_noise: ['f64', 32],
    gyro_walk: ['f64', 40],
    accel_noise: ['f64', 48],
    accel_walk: ['f64', 56],
  }},
  waypoint: {size: 88, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    p_n: ['f64', 32, 3],
    sigma_m: ['f64', 56],
    lever_b: ['f64', 64, 3],
  }},
  earth_field: {size: 56, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    declination_rad: ['f64', 32],
    inclination_rad: ['f64', 40],
    intensity_t: ['f64', 48],
  }},
  platform_pose: {size: 384, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    q_w: ['f64', 32, 4],
    p_w: ['f64', 64, 3],
    covariance: ['f64', 88, 36],
    state: ['u32', 376],
    world: ['u32', 380],
  }},
  range: {size: 112, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    transmitter: ['u64', 32],
    range_m: ['f64', 40],
    sigma_m: ['f64', 48],
    p_n: ['f64', 56, 3],
    transmitter_sigma_m: ['f64', 80],
    lever_b: ['f64', 88, 3],
  }},
  system_step: {size: 48, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    count: ['u64', 32],
    distance_m: ['f64', 40],
  }},
  frame: {size: 256, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    loan_owner: ['ptr', 32],
    loan_retain: ['ptr', 40],
    loan_release: ['ptr', 48],
    loan_native: ['ptr', 56],
    loan_reserved: ['u64', 64],
    format: ['u32', 72],
    width: ['u32', 76],
    height: ['u32', 80],
    plane_count: ['u32', 84],
    planes0_data: ['ptr', 88],
    planes0_row_stride: ['i64', 96],
    planes0_pixel_stride: ['u32', 104],
    planes0_rows: ['u32', 108],
    planes1_data: ['ptr', 112],
    planes1_row_stride: ['i64', 120],
    planes1_pixel_stride: ['u32', 128],
    planes1_rows: ['u32', 132],
    planes2_data: ['ptr', 136],
    planes2_row_stride: ['i64', 144],
    planes2_pixel_stride: ['u32', 152],
    planes2_rows: ['u32', 156],
    planes3_data: ['ptr', 160],
    planes3_row_stride: ['i64', 168],
    planes3_pixel_stride: ['u32', 176],
    planes3_rows: ['u32', 180],
    mask_data: ['ptr', 184],
    mask_row_stride: ['i64', 192],
    mask_pixel_stride: ['u32', 200],
    mask_rows: ['u32', 204],
    exposure_ns: ['i64', 208],
    line_time_ns: ['i64', 216],
    fx: ['f64', 224],
    fy: ['f64', 232],
    cx: ['f64', 240],
    cy: ['f64', 248],
  }},
  attitude: {size: 160, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    q_n_b: ['f64', 32, 4],
    covariance_n: ['f64', 64, 9],
    gyro_bias_b: ['f64', 136, 3],
  }},
  step: {size: 96, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    t_start_ns: ['i64', 32],
    t_end_ns: ['i64', 40],
    length_m: ['f64', 48],
    sigma_m: ['f64', 56],
    frequency_hz: ['f64', 64],
    heading_rad: ['f64', 72],
    mode: ['u32', 80],
    index: ['u32', 84],
    heading_sigma_rad: ['f64', 88],
  }},
  motion_mode: {size: 40, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    mode: ['u32', 32],
  }},
  vo_motion: {size: 544, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    t_from_ns: ['i64', 32],
    q_c0_c1: ['f64', 40, 4],
    p_c0_c1: ['f64', 72, 3],
    covariance: ['f64', 96, 36],
    q_n_c0: ['f64', 384, 4],
    camera: ['u32', 416],
    state: ['u32', 420],
    reason: ['u32', 424],
    scale_group: ['u32', 428],
    tracked: ['u32', 432],
    inliers: ['u32', 436],
    scale_sigma: ['f64', 440],
    velocity_c1: ['f64', 448, 3],
    gravity_c1: ['f64', 472, 3],
    gyro_bias_b: ['f64', 496, 3],
    accel_bias_b: ['f64', 520, 3],
  }},
  scale: {size: 80, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    valid_from_ns: ['i64', 32],
    valid_to_ns: ['i64', 40],
    scale: ['f64', 48],
    sigma: ['f64', 56],
    displacement_m: ['f64', 64],
    scale_group: ['u32', 72],
  }},
  fix: {size: 440, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    p_n: ['f64', 32, 3],
    covariance_n: ['f64', 56, 9],
    q_n_b: ['f64', 128, 4],
    orientation_cov_n: ['f64', 160, 9],
    yaw_rad: ['f64', 232],
    yaw_sigma_rad: ['f64', 240],
    latitude_rad: ['f64', 248],
    longitude_rad: ['f64', 256],
    height_m: ['f64', 264],
    integrity: ['f64', 272],
    landmark_n: ['f64', 280, 3],
    slant_distance_m: ['f64', 304],
    lever_b: ['f64', 312, 3],
    yaw_axis_b: ['f64', 336, 3],
    cross_covariance_n: ['f64', 360, 9],
    slant_sigma_m: ['f64', 432],
  }},
  pose: {size: 544, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    q_n: ['f64', 32, 4],
    p_n: ['f64', 64, 3],
    velocity_n: ['f64', 88, 3],
    covariance: ['f64', 112, 36],
    scale: ['f64', 400],
    scale_sigma: ['f64', 408],
    distance_m: ['f64', 416],
    state: ['u32', 424],
    reason: ['u32', 428],
    angular_velocity: ['f64', 432, 3],
    velocity_covariance: ['f64', 456, 9],
    floor: ['i32', 528],
    floor_probability: ['f64', 536],
  }},
  state: {size: 40, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    state: ['u32', 32],
    reason: ['u32', 36],
  }},
  correction: {size: 96, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    q_n: ['f64', 32, 4],
    p_n: ['f64', 64, 3],
    reason: ['u32', 88],
  }},
  report: {size: 1200, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    count: ['u64', 32],
    severity: ['u32', 40],
    status: ['i32', 44],
    plugin: ['char', 48, 64],
    key: ['char', 112, 64],
    text: ['char', 176, 1024],
  }},
  refined: {size: 224, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    camera: ['u32', 32],
    model: ['u32', 36],
    width: ['u32', 40],
    height: ['u32', 44],
    distortion_count: ['u32', 48],
    fx: ['f64', 56],
    fy: ['f64', 64],
    cx: ['f64', 72],
    cy: ['f64', 80],
    distortion: ['f64', 88, 8],
    q_b_c: ['f64', 152, 4],
    p_b_c: ['f64', 184, 3],
    time_offset_ns: ['i64', 208],
    line_time_ns: ['i64', 216],
  }},
  relative_pose: {size: 384, fields: {
    t_ns: ['i64', 8],
    source: ['u32', 16],
    flags: ['u32', 20],
    quality: ['f32', 24],
    t_from_ns: ['i64', 32],
    q_b0_b1: ['f64', 40, 4],
    p_b0_b1: ['f64', 72, 3],
    covariance: ['f64', 96, 36],
  }},
  string: {size: 16, fields: {
    data: ['ptr', 0],
    size: ['u64', 8],
  }},
  error: {size: 2048, fields: {
    status: ['i32', 4],
    message: ['char', 8, 2040],
  }},
  session_options: {size: 104, fields: {
    run: ['u32', 4],
    config_path_data: ['ptr', 8],
    config_path_size: ['u64', 16],
    config_text_data: ['ptr', 24],
    config_text_size: ['u64', 32],
    plugin_path_data: ['ptr', 40],
    plugin_path_size: ['u64', 48],
    seed: ['u64', 56],
    asset_path_data: ['ptr', 64],
    asset_path_size: ['u64', 72],
    flags: ['u32', 80],
    user: ['ptr', 88],
    get_service: ['ptr', 96],
  }},
  statistics: {size: 184, fields: {
    pushed: ['u64', 8],
    processed: ['u64', 16],
    frames: ['u64', 24],
    steps: ['u64', 32],
    fixes_accepted: ['u64', 40],
    fixes_rejected: ['u64', 48],
    late: ['u64', 56],
    duplicate: ['u64', 64],
    invalid: ['u64', 72],
    overflow: ['u64', 80],
    gaps: ['u64', 88],
    plugin_faults: ['u64', 96],
    tracking_s: ['f64', 104],
    degraded_s: ['f64', 112],
    lost_s: ['f64', 120],
    distance_m: ['f64', 128],
    wild: ['u64', 136],
    events_dropped: ['u64', 144],
    unknown: ['u64', 152],
    scale_sigma: ['f64', 160],
    scale_by_inertia: ['f64', 168],
    scale_by_steps: ['f64', 176],
  }},
  anchor_place: {size: 136, fields: {
    kind: ['u32', 4],
    t_ns: ['i64', 8],
    world: ['u32', 16],
    height_above: ['u32', 20],
    q: ['f64', 24, 4],
    p: ['f64', 56, 3],
    latitude_rad: ['f64', 80],
    longitude_rad: ['f64', 88],
    height_m: ['f64', 96],
    geoid_height_m: ['f64', 104],
    sigma_m: ['f64', 112],
    name_data: ['ptr', 120],
    name_size: ['u64', 128],
  }},
  anchor: {size: 264, fields: {
    kind: ['u32', 4],
    id: ['u64', 8],
    t_ns: ['i64', 16],
    flags: ['u32', 24],
    state: ['u32', 28],
    reason: ['u32', 32],
    q_n: ['f64', 40, 4],
    p_n: ['f64', 72, 3],
    q_view: ['f64', 96, 4],
    p_view: ['f64', 128, 3],
    position_sigma_m: ['f64', 152],
    yaw_sigma_rad: ['f64', 160],
    view_sigma_m: ['f64', 168],
    latitude_rad: ['f64', 176],
    longitude_rad: ['f64', 184],
    height_m: ['f64', 192],
    name: ['char', 200, 64],
  }},
};
