// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
//! The C ABI, documented in the headers of odograph.
#![allow(non_camel_case_types)]
use std::os::raw::{c_char, c_void};

#[cfg(not(target_pointer_width = "64"))]
compile_error!("pointers have 8 bytes in the structs of Odograph's ABI; this crate supports 64-bit targets");

/// A message: a struct that starts with an [`odo_header`] and is zero by default.
///
/// # Safety
/// The type must be `#[repr(C)]`, start with an [`odo_header`], and be valid for any bytes.
pub unsafe trait Message: Copy {
    /// ODO_TYPE_*
    const TYPE: u32;

    /// A zeroed message with size, type and time set.
    fn at(t_ns: i64) -> Self {
        unsafe {
            let mut made: Self = std::mem::zeroed();
            let header = &mut *(&mut made as *mut Self as *mut odo_header);
            header.struct_size = std::mem::size_of::<Self>() as u32;
            header.kind = Self::TYPE;
            header.t_ns = t_ns;
            made
        }
    }
}
pub const ODO_ABI_MAJOR: u32 = 1;
pub const ODO_ABI_MINOR: u32 = 0;
pub const ODO_OK: i32 = 0;
pub const ODO_NOT_READY: i32 = 1;
pub const ODO_END: i32 = 2;
pub const ODO_PARTIAL: i32 = 3;
pub const ODO_E_ARGUMENT: i32 = -1;
pub const ODO_E_DISCARD: i32 = -2;
pub const ODO_E_EXHAUSTED: i32 = -3;
pub const ODO_E_UNSUPPORTED: i32 = -4;
pub const ODO_E_STRUCT_SIZE: i32 = -5;
pub const ODO_E_VERSION: i32 = -6;
pub const ODO_E_STATE: i32 = -7;
pub const ODO_E_CONFIG: i32 = -8;
pub const ODO_E_NOT_FOUND: i32 = -9;
pub const ODO_E_DATA: i32 = -10;
pub const ODO_E_IO: i32 = -11;
pub const ODO_E_MEMORY: i32 = -1001;
pub const ODO_E_ERROR: i32 = -1002;
pub const ODO_E_FATAL: i32 = -2001;
pub const ODO_BORROWED: u32 = 2048;
pub const ODO_TYPE_IMU: u32 = 1;
pub const ODO_TYPE_MAGNETOMETER: u32 = 2;
pub const ODO_TYPE_BAROMETER: u32 = 3;
pub const ODO_TYPE_GNSS: u32 = 4;
pub const ODO_TYPE_CALIBRATION: u32 = 5;
pub const ODO_TYPE_IMU_NOISE: u32 = 6;
pub const ODO_TYPE_WAYPOINT: u32 = 7;
pub const ODO_TYPE_EARTH_FIELD: u32 = 8;
pub const ODO_TYPE_PLATFORM_POSE: u32 = 9;
pub const ODO_TYPE_RANGE: u32 = 10;
pub const ODO_TYPE_SYSTEM_STEP: u32 = 11;
pub const ODO_TYPE_FRAME: u32 = 2049;
pub const ODO_TYPE_ATTITUDE: u32 = 4097;
pub const ODO_TYPE_STEP: u32 = 4098;
pub const ODO_TYPE_MOTION_MODE: u32 = 4099;
pub const ODO_TYPE_VO_MOTION: u32 = 4100;
pub const ODO_TYPE_SCALE: u32 = 4101;
pub const ODO_TYPE_FIX: u32 = 4102;
pub const ODO_TYPE_POSE: u32 = 4103;
pub const ODO_TYPE_STATE: u32 = 4104;
pub const ODO_TYPE_CORRECTION: u32 = 4105;
pub const ODO_TYPE_REPORT: u32 = 4106;
pub const ODO_TYPE_REFINED: u32 = 4107;
pub const ODO_TYPE_RELATIVE_POSE: u32 = 4108;
pub const ODO_VENDOR_EVENT: u32 = 1024;
pub const ODO_LARGEST_MESSAGE: u32 = 65536;
pub const ODO_FLAG_QUALITY: u32 = 2147483648;
pub const ODO_FLAG_DESCRIPTION: u32 = 268435456;
pub const ODO_FLAG_HOST_MASK: u32 = 251658240;
pub const ODO_FLAG_ACCEPTED: u32 = 16777216;
pub const ODO_FLAG_NAVIGATION: u32 = 33554432;
pub const ODO_NATIVE_HARDWARE_BUFFER: &str = "android.hardware_buffer/1";
pub const ODO_NATIVE_PIXEL_BUFFER: &str = "apple.pixel_buffer/1";
pub const ODO_ATTITUDE_MAGNETIC_NORTH: u32 = 1;
pub const ODO_ATTITUDE_MAG_DISTURBED: u32 = 2;
pub const ODO_ATTITUDE_REST: u32 = 4;
pub const ODO_ATTITUDE_TRUE_NORTH: u32 = 8;
pub const ODO_ATTITUDE_COVARIANCE: u32 = 16;
pub const ODO_ATTITUDE_GYRO_BIAS: u32 = 32;
pub const ODO_MODE_UNKNOWN: u32 = 0;
pub const ODO_MODE_STATIC: u32 = 1;
pub const ODO_MODE_WALKING_TEXTING: u32 = 2;
pub const ODO_MODE_WALKING_SWINGING: u32 = 3;
pub const ODO_MODE_WALKING_POCKET: u32 = 4;
pub const ODO_MODE_STAIRS: u32 = 5;
pub const ODO_MODE_RUNNING: u32 = 6;
pub const ODO_MODE_HANDLING: u32 = 7;
pub const ODO_STEP_HEADING: u32 = 1;
pub const ODO_STEP_HEADING_SIGMA: u32 = 2;
pub const ODO_TRACKING: u32 = 1;
pub const ODO_DEGRADED: u32 = 2;
pub const ODO_LOST: u32 = 3;
pub const ODO_REASON_NONE: u32 = 0;
pub const ODO_REASON_INITIALISING: u32 = 1;
pub const ODO_REASON_TOO_DARK: u32 = 2;
pub const ODO_REASON_TOO_FAST: u32 = 3;
pub const ODO_REASON_FEW_FEATURES: u32 = 4;
pub const ODO_REASON_NO_PARALLAX: u32 = 5;
pub const ODO_REASON_NO_STEPS: u32 = 6;
pub const ODO_REASON_SENSOR_SILENT: u32 = 7;
pub const ODO_REASON_PLUGIN_FAILED: u32 = 8;
pub const ODO_REASON_NO_SCALE: u32 = 9;
pub const ODO_VO_ROTATION: u32 = 1;
pub const ODO_VO_TRANSLATION: u32 = 2;
pub const ODO_VO_COVARIANCE: u32 = 4;
pub const ODO_VO_METRIC: u32 = 8;
pub const ODO_VO_INERTIAL: u32 = 16;
pub const ODO_SCALE_HORIZONTAL: u32 = 1;
pub const ODO_SCALE_STEADY: u32 = 2;
pub const ODO_SCALE_NOT_BY_STEPS: u32 = 4;
pub const ODO_FIX_NORTH: u32 = 1;
pub const ODO_FIX_EAST: u32 = 2;
pub const ODO_FIX_DOWN: u32 = 4;
pub const ODO_FIX_YAW: u32 = 8;
pub const ODO_FIX_ORIENTATION: u32 = 16;
pub const ODO_FIX_GEODETIC: u32 = 32;
pub const ODO_FIX_SLANT: u32 = 64;
pub const ODO_FIX_COVARIANCE: u32 = 128;
pub const ODO_FIX_ORIENTATION_COVARIANCE: u32 = 256;
pub const ODO_FIX_INTEGRITY: u32 = 512;
pub const ODO_FIX_LEVER: u32 = 1024;
pub const ODO_FIX_CROSS_COVARIANCE: u32 = 2048;
pub const ODO_FIX_SLANT_SIGMA: u32 = 4096;
pub const ODO_RELATIVE_POSE_TRANSLATION: u32 = 1;
pub const ODO_RELATIVE_POSE_ROTATION: u32 = 2;
pub const ODO_POSE_ORIENTATION: u32 = 1;
pub const ODO_POSE_POSITION: u32 = 2;
pub const ODO_POSE_VELOCITY: u32 = 4;
pub const ODO_POSE_METRIC: u32 = 8;
pub const ODO_POSE_CAMERA: u32 = 16;
pub const ODO_POSE_EXTRAPOLATED: u32 = 32;
pub const ODO_POSE_ANGULAR_VELOCITY: u32 = 64;
pub const ODO_POSE_VELOCITY_COVARIANCE: u32 = 128;
pub const ODO_POSE_COVARIANCE: u32 = 256;
pub const ODO_POSE_NORTH: u32 = 512;
pub const ODO_POSE_FLOOR: u32 = 1024;
pub const ODO_POSE_CARRIED: u32 = 2048;
pub const ODO_CORRECTION_FIX: u32 = 1;
pub const ODO_CORRECTION_SCALE: u32 = 2;
pub const ODO_CORRECTION_RECOVERED: u32 = 3;
pub const ODO_CORRECTION_RESTART: u32 = 4;
pub const ODO_REFINED_EXTRINSICS: u32 = 1;
pub const ODO_REFINED_TIME_OFFSET: u32 = 2;
pub const ODO_REFINED_LINE_TIME: u32 = 4;
pub const ODO_SEVERITY_DEBUG: u32 = 0;
pub const ODO_SEVERITY_INFO: u32 = 1;
pub const ODO_SEVERITY_WARNING: u32 = 2;
pub const ODO_SEVERITY_ERROR: u32 = 3;
pub const ODO_IMU_GYRO: u32 = 1;
pub const ODO_IMU_ACCEL: u32 = 2;
pub const ODO_IMU_GYRO_CORRECTED: u32 = 4;
pub const ODO_IMU_ACCEL_CORRECTED: u32 = 8;
pub const ODO_MAGNETOMETER_SIGMA: u32 = 1;
pub const ODO_MAGNETOMETER_CORRECTED: u32 = 2;
pub const ODO_BAROMETER_SIGMA: u32 = 1;
pub const ODO_GNSS_POSITION: u32 = 1;
pub const ODO_GNSS_HEIGHT: u32 = 2;
pub const ODO_GNSS_COVARIANCE: u32 = 4;
pub const ODO_GNSS_VELOCITY: u32 = 8;
pub const ODO_GNSS_LEVER: u32 = 16;
pub const ODO_FORMAT_GREY8: u32 = 1;
pub const ODO_FORMAT_NV12: u32 = 2;
pub const ODO_FORMAT_NV21: u32 = 3;
pub const ODO_FORMAT_RGB8: u32 = 4;
pub const ODO_FORMAT_RGBA8: u32 = 5;
pub const ODO_FORMAT_YUV420: u32 = 6;
pub const ODO_FORMAT_BGRA8: u32 = 7;
pub const ODO_FRAME_EXPOSURE: u32 = 1;
pub const ODO_FRAME_LINE_TIME: u32 = 2;
pub const ODO_FRAME_MASK: u32 = 4;
pub const ODO_FRAME_INTRINSICS: u32 = 8;
pub const ODO_CAMERA_PINHOLE: u32 = 1;
pub const ODO_CAMERA_KANNALA_BRANDT: u32 = 2;
pub const ODO_CALIBRATION_EXTRINSICS: u32 = 1;
pub const ODO_CALIBRATION_TIME_OFFSET: u32 = 2;
pub const ODO_CALIBRATION_LINE_TIME: u32 = 4;
pub const ODO_WAYPOINT_VERTICAL: u32 = 1;
pub const ODO_WAYPOINT_LEVER: u32 = 2;
pub const ODO_EARTH_FIELD_DECLINATION: u32 = 1;
pub const ODO_EARTH_FIELD_INCLINATION: u32 = 2;
pub const ODO_EARTH_FIELD_INTENSITY: u32 = 4;
pub const ODO_PLATFORM_POSE_CAMERA: u32 = 1;
pub const ODO_PLATFORM_POSE_COVARIANCE: u32 = 2;
pub const ODO_RANGE_TRANSMITTER: u32 = 1;
pub const ODO_RANGE_LEVER: u32 = 2;
pub const ODO_SYSTEM_STEP_COUNT: u32 = 1;
pub const ODO_SYSTEM_STEP_DISTANCE: u32 = 2;
pub const ODO_SERVICE_REPORT: &str = "odo.report/1";
pub const ODO_SERVICE_RANDOM: &str = "odo.random/1";
pub const ODO_SERVICE_ASSETS: &str = "odo.assets/1";
pub const ODO_SERVICE_CONTENTS: &str = "odo.contents/1";
pub const ODO_SERVICE_WAKE: &str = "odo.wake/1";
pub const ODO_PARAMETER_BOOL: u32 = 1;
pub const ODO_PARAMETER_INT: u32 = 2;
pub const ODO_PARAMETER_REAL: u32 = 3;
pub const ODO_PARAMETER_STRING: u32 = 4;
pub const ODO_PARAMETER_CHOICE: u32 = 5;
pub const ODO_PARAMETER_REALS: u32 = 6;
pub const ODO_LARGEST_STATE: u32 = 16777216;
pub const ODO_PLUGIN_SEVERAL_CAMERAS: u32 = 1;
pub const ODO_PLUGIN_NATIVE_FRAMES: u32 = 2;
pub const ODO_PLUGIN_ENTRY_SYMBOL: &str = "odo_plugin_entry_v1";
pub const ODO_INTERFACE_ABSOLUTE_FIXER: &str = "odo.absolute_fixer/1";
pub const ODO_RUN_LIVE: u32 = 0;
pub const ODO_RUN_REPLAY: u32 = 1;
pub const ODO_SESSION_CRASH_NOTES: u32 = 1;
pub const ODO_TIME_LATEST: i64 = -9223372036854775808;
pub const ODO_WORLD_CORRECTED: u32 = 0;
pub const ODO_WORLD_SMOOTH: u32 = 1;
pub const ODO_OF_PIPELINE: u32 = 0;
pub const ODO_OF_BODY: u32 = 1;
pub const ODO_OF_CAMERA: u32 = 2;
pub const ODO_ALL_EVENTS: u32 = 4294967295;
pub const ODO_ANCHOR_POSE: u32 = 1;
pub const ODO_ANCHOR_VIEW: u32 = 2;
pub const ODO_ANCHOR_GEODETIC: u32 = 3;
pub const ODO_HEIGHT_ELLIPSOID: u32 = 1;
pub const ODO_HEIGHT_GEOID: u32 = 2;
pub const ODO_HEIGHT_TERRAIN: u32 = 3;
pub const ODO_ANCHOR_PLACED: u32 = 1;
pub const ODO_ANCHOR_VIEW_POSE: u32 = 2;
pub const ODO_ANCHOR_ON_EARTH: u32 = 4;
pub const ODO_ANCHOR_IN_FRONT: u32 = 8;
pub const ODO_REASON_NO_FIX: u32 = 10;
pub const ODO_REASON_NO_GROUND: u32 = 11;
pub const ODO_REASON_NO_ORIGIN: u32 = 12;
pub const ODO_INTERFACE_ATTITUDE: &str = "odo.attitude/1";
pub const ODO_LARGEST_PICTURE: u32 = 67108864;
pub const ODO_INTERFACE_SCALE_SOURCE: &str = "odo.scale_source/1";
pub const ODO_INTERFACE_STEP_ESTIMATOR: &str = "odo.step_estimator/1";
pub const ODO_EXTENSION_TERRAIN: &str = "odo.terrain/1";
pub const ODO_INTERFACE_VO_FRONTEND: &str = "odo.vo_frontend/1";
/// Size of version 1.0 of the plugin's table.
pub const ODO_PLUGIN_SIZE_MIN: u32 = 208;

#[repr(C)]
pub struct odo_asset {
    _private: [u8; 0],
}
#[repr(C)]
pub struct odo_instance {
    _private: [u8; 0],
}
#[repr(C)]
pub struct odo_session {
    _private: [u8; 0],
}
#[repr(C)]
pub struct odo_recording {
    _private: [u8; 0],
}
#[repr(C)]
pub struct odo_recorder {
    _private: [u8; 0],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_string {
    pub data: *const c_char,
    pub size: u64,
}
impl Default for odo_string {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_header {
    pub struct_size: u32,
    pub kind: u32,
    pub t_ns: i64,
    pub source: u32,
    pub flags: u32,
    pub quality: f32,
    pub reserved: u32,
}
impl Default for odo_header {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_loan {
    pub owner: *mut c_void,
    pub retain: Option<unsafe extern "C" fn(*mut c_void) -> i32>,
    pub release: Option<unsafe extern "C" fn(*mut c_void)>,
    pub native: Option<unsafe extern "C" fn(*mut c_void, *const c_char, u64) -> *const c_void>,
    pub reserved: u64,
}
impl Default for odo_loan {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_borrowed {
    pub header: odo_header,
    pub loan: odo_loan,
}
impl Default for odo_borrowed {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_attitude {
    pub header: odo_header,
    pub q_n_b: [f64; 4],
    pub covariance_n: [f64; 9],
    pub gyro_bias_b: [f64; 3],
}
impl Default for odo_attitude {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_step {
    pub header: odo_header,
    pub t_start_ns: i64,
    pub t_end_ns: i64,
    pub length_m: f64,
    pub sigma_m: f64,
    pub frequency_hz: f64,
    pub heading_rad: f64,
    pub mode: u32,
    pub index: u32,
    pub heading_sigma_rad: f64,
}
impl Default for odo_step {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_motion_mode {
    pub header: odo_header,
    pub mode: u32,
    pub reserved: u32,
}
impl Default for odo_motion_mode {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_vo_motion {
    pub header: odo_header,
    pub t_from_ns: i64,
    pub q_c0_c1: [f64; 4],
    pub p_c0_c1: [f64; 3],
    pub covariance: [f64; 36],
    pub q_n_c0: [f64; 4],
    pub camera: u32,
    pub state: u32,
    pub reason: u32,
    pub scale_group: u32,
    pub tracked: u32,
    pub inliers: u32,
    pub scale_sigma: f64,
    pub velocity_c1: [f64; 3],
    pub gravity_c1: [f64; 3],
    pub gyro_bias_b: [f64; 3],
    pub accel_bias_b: [f64; 3],
}
impl Default for odo_vo_motion {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_scale {
    pub header: odo_header,
    pub valid_from_ns: i64,
    pub valid_to_ns: i64,
    pub scale: f64,
    pub sigma: f64,
    pub displacement_m: f64,
    pub scale_group: u32,
    pub reserved: u32,
}
impl Default for odo_scale {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_fix {
    pub header: odo_header,
    pub p_n: [f64; 3],
    pub covariance_n: [f64; 9],
    pub q_n_b: [f64; 4],
    pub orientation_cov_n: [f64; 9],
    pub yaw_rad: f64,
    pub yaw_sigma_rad: f64,
    pub latitude_rad: f64,
    pub longitude_rad: f64,
    pub height_m: f64,
    pub integrity: f64,
    pub landmark_n: [f64; 3],
    pub slant_distance_m: f64,
    pub lever_b: [f64; 3],
    pub yaw_axis_b: [f64; 3],
    pub cross_covariance_n: [f64; 9],
    pub slant_sigma_m: f64,
}
impl Default for odo_fix {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_relative_pose {
    pub header: odo_header,
    pub t_from_ns: i64,
    pub q_b0_b1: [f64; 4],
    pub p_b0_b1: [f64; 3],
    pub covariance: [f64; 36],
}
impl Default for odo_relative_pose {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_pose {
    pub header: odo_header,
    pub q_n: [f64; 4],
    pub p_n: [f64; 3],
    pub velocity_n: [f64; 3],
    pub covariance: [f64; 36],
    pub scale: f64,
    pub scale_sigma: f64,
    pub distance_m: f64,
    pub state: u32,
    pub reason: u32,
    pub angular_velocity: [f64; 3],
    pub velocity_covariance: [f64; 9],
    pub floor: i32,
    pub reserved: u32,
    pub floor_probability: f64,
}
impl Default for odo_pose {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_state {
    pub header: odo_header,
    pub state: u32,
    pub reason: u32,
}
impl Default for odo_state {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_correction {
    pub header: odo_header,
    pub q_n: [f64; 4],
    pub p_n: [f64; 3],
    pub reason: u32,
    pub reserved: u32,
}
impl Default for odo_correction {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_refined {
    pub header: odo_header,
    pub camera: u32,
    pub model: u32,
    pub width: u32,
    pub height: u32,
    pub distortion_count: u32,
    pub reserved: u32,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    pub distortion: [f64; 8],
    pub q_b_c: [f64; 4],
    pub p_b_c: [f64; 3],
    pub time_offset_ns: i64,
    pub line_time_ns: i64,
}
impl Default for odo_refined {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_report {
    pub header: odo_header,
    pub count: u64,
    pub severity: u32,
    pub status: i32,
    pub plugin: [c_char; 64],
    pub key: [c_char; 64],
    pub text: [c_char; 1024],
}
impl Default for odo_report {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_imu {
    pub header: odo_header,
    pub gyro_b: [f64; 3],
    pub accel_b: [f64; 3],
}
impl Default for odo_imu {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_magnetometer {
    pub header: odo_header,
    pub field_b: [f64; 3],
    pub sigma_t: f64,
}
impl Default for odo_magnetometer {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_barometer {
    pub header: odo_header,
    pub pressure_pa: f64,
    pub sigma_pa: f64,
}
impl Default for odo_barometer {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_gnss {
    pub header: odo_header,
    pub latitude_rad: f64,
    pub longitude_rad: f64,
    pub height_m: f64,
    pub covariance_n: [f64; 9],
    pub velocity_n: [f64; 3],
    pub satellites: u32,
    pub reserved: u32,
    pub lever_b: [f64; 3],
}
impl Default for odo_gnss {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_plane {
    pub data: *const u8,
    pub row_stride: i64,
    pub pixel_stride: u32,
    pub rows: u32,
}
impl Default for odo_plane {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_frame {
    pub header: odo_header,
    pub loan: odo_loan,
    pub format: u32,
    pub width: u32,
    pub height: u32,
    pub plane_count: u32,
    pub planes: [odo_plane; 4],
    pub mask: odo_plane,
    pub exposure_ns: i64,
    pub line_time_ns: i64,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
}
impl Default for odo_frame {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_calibration {
    pub header: odo_header,
    pub model: u32,
    pub width: u32,
    pub height: u32,
    pub distortion_count: u32,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    pub distortion: [f64; 8],
    pub q_b_c: [f64; 4],
    pub p_b_c: [f64; 3],
    pub time_offset_ns: i64,
    pub line_time_ns: i64,
}
impl Default for odo_calibration {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_imu_noise {
    pub header: odo_header,
    pub gyro_noise: f64,
    pub gyro_walk: f64,
    pub accel_noise: f64,
    pub accel_walk: f64,
}
impl Default for odo_imu_noise {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_waypoint {
    pub header: odo_header,
    pub p_n: [f64; 3],
    pub sigma_m: f64,
    pub lever_b: [f64; 3],
}
impl Default for odo_waypoint {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_earth_field {
    pub header: odo_header,
    pub declination_rad: f64,
    pub inclination_rad: f64,
    pub intensity_t: f64,
}
impl Default for odo_earth_field {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_platform_pose {
    pub header: odo_header,
    pub q_w: [f64; 4],
    pub p_w: [f64; 3],
    pub covariance: [f64; 36],
    pub state: u32,
    pub world: u32,
}
impl Default for odo_platform_pose {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_range {
    pub header: odo_header,
    pub transmitter: u64,
    pub range_m: f64,
    pub sigma_m: f64,
    pub p_n: [f64; 3],
    pub transmitter_sigma_m: f64,
    pub lever_b: [f64; 3],
}
impl Default for odo_range {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_system_step {
    pub header: odo_header,
    pub count: u64,
    pub distance_m: f64,
}
impl Default for odo_system_step {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_host {
    pub struct_size: u32,
    pub abi_major_min: u32,
    pub abi_major_max: u32,
    pub abi_minor: u32,
    pub version: odo_string,
    pub get_service: Option<unsafe extern "C" fn(*const odo_host, *const c_char, u64) -> *const c_void>,
}
impl Default for odo_host {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_report_service {
    pub struct_size: u32,
    pub reserved: u32,
    pub report: Option<unsafe extern "C" fn(*const odo_host, u32, u32, *const odo_string, *const odo_string)>,
}
impl Default for odo_report_service {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_random_service {
    pub struct_size: u32,
    pub reserved: u32,
    pub seed: Option<unsafe extern "C" fn(*const odo_host, u32, u64) -> u64>,
}
impl Default for odo_random_service {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_asset_service {
    pub struct_size: u32,
    pub reserved: u32,
    pub resolve: Option<unsafe extern "C" fn(*const odo_host, *const odo_string, *mut c_char, u64) -> i64>,
}
impl Default for odo_asset_service {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_content_service {
    pub struct_size: u32,
    pub reserved: u32,
    pub user: *mut c_void,
    pub open: Option<unsafe extern "C" fn(*mut c_void, *const odo_string, *mut *mut odo_asset, *mut u64) -> i32>,
    pub read: Option<unsafe extern "C" fn(*mut odo_asset, u64, *mut c_void, u64) -> i64>,
    pub close: Option<unsafe extern "C" fn(*mut odo_asset)>,
}
impl Default for odo_content_service {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_wake_service {
    pub struct_size: u32,
    pub reserved: u32,
    pub wake: Option<unsafe extern "C" fn(*const odo_host, u32)>,
}
impl Default for odo_wake_service {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_parameter {
    pub struct_size: u32,
    pub kind: u32,
    pub name: odo_string,
    pub unit: odo_string,
    pub help: odo_string,
    pub default_text: odo_string,
    pub choices: odo_string,
    pub min: f64,
    pub max: f64,
    pub count: u32,
    pub reserved: u32,
}
impl Default for odo_parameter {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_value {
    pub struct_size: u32,
    pub kind: u32,
    pub name: odo_string,
    pub text: odo_string,
    pub reals: *const f64,
    pub count: u64,
    pub integer: i64,
}
impl Default for odo_value {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_batch {
    pub struct_size: u32,
    pub count: u32,
    pub messages: *const *const odo_header,
}
impl Default for odo_batch {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_sink {
    pub struct_size: u32,
    pub instance: u32,
    pub emit: Option<unsafe extern "C" fn(*const odo_sink, *const odo_header) -> i32>,
}
impl Default for odo_sink {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_plugin {
    pub struct_size: u32,
    pub abi_major: u32,
    pub abi_minor: u32,
    pub interface_count: u32,
    pub interfaces: *const odo_string,
    pub id: odo_string,
    pub version: odo_string,
    pub summary: odo_string,
    pub refusal: odo_string,
    pub parameters: *const odo_parameter,
    pub parameter_count: u32,
    pub parameter_stride: u32,
    pub flags: u32,
    pub reserved: u32,
    pub create: Option<unsafe extern "C" fn(*const odo_host, u32, *const odo_string, *mut *mut odo_instance) -> i32>,
    pub configure: Option<unsafe extern "C" fn(*mut odo_instance, *const odo_value, u32, u32) -> i32>,
    pub activate: Option<unsafe extern "C" fn(*mut odo_instance, *const odo_sink) -> i32>,
    pub process: Option<unsafe extern "C" fn(*mut odo_instance, *const odo_batch) -> i32>,
    pub destroy: Option<unsafe extern "C" fn(*mut odo_instance)>,
    pub reset: Option<unsafe extern "C" fn(*mut odo_instance) -> i32>,
    pub save: Option<unsafe extern "C" fn(*mut odo_instance, *mut c_void, u64) -> i64>,
    pub load: Option<unsafe extern "C" fn(*mut odo_instance, *const c_void, u64) -> i32>,
    pub get_interface: Option<unsafe extern "C" fn(*mut odo_instance, *const c_char, u64) -> *const c_void>,
    pub inputs: *const u32,
    pub outputs: *const u32,
    pub input_count: u32,
    pub output_count: u32,
}
impl Default for odo_plugin {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_error {
    pub struct_size: u32,
    pub status: i32,
    pub message: [c_char; 2040],
}
impl Default for odo_error {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_session_options {
    pub struct_size: u32,
    pub run: u32,
    pub config_path: odo_string,
    pub config_text: odo_string,
    pub plugin_path: odo_string,
    pub seed: u64,
    pub asset_path: odo_string,
    pub flags: u32,
    pub reserved: u32,
    pub user: *mut c_void,
    pub get_service: Option<unsafe extern "C" fn(*mut c_void, *const c_char, u64) -> *const c_void>,
}
impl Default for odo_session_options {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_statistics {
    pub struct_size: u32,
    pub reserved: u32,
    pub pushed: u64,
    pub processed: u64,
    pub frames: u64,
    pub steps: u64,
    pub fixes_accepted: u64,
    pub fixes_rejected: u64,
    pub late: u64,
    pub duplicate: u64,
    pub invalid: u64,
    pub overflow: u64,
    pub gaps: u64,
    pub plugin_faults: u64,
    pub tracking_s: f64,
    pub degraded_s: f64,
    pub lost_s: f64,
    pub distance_m: f64,
    pub wild: u64,
    pub events_dropped: u64,
    pub unknown: u64,
    pub scale_sigma: f64,
    pub scale_by_inertia: f64,
    pub scale_by_steps: f64,
}
impl Default for odo_statistics {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_anchor_place {
    pub struct_size: u32,
    pub kind: u32,
    pub t_ns: i64,
    pub world: u32,
    pub height_above: u32,
    pub q: [f64; 4],
    pub p: [f64; 3],
    pub latitude_rad: f64,
    pub longitude_rad: f64,
    pub height_m: f64,
    pub geoid_height_m: f64,
    pub sigma_m: f64,
    pub name: odo_string,
}
impl Default for odo_anchor_place {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_anchor {
    pub struct_size: u32,
    pub kind: u32,
    pub id: u64,
    pub t_ns: i64,
    pub flags: u32,
    pub state: u32,
    pub reason: u32,
    pub reserved: u32,
    pub q_n: [f64; 4],
    pub p_n: [f64; 3],
    pub q_view: [f64; 4],
    pub p_view: [f64; 3],
    pub position_sigma_m: f64,
    pub yaw_sigma_rad: f64,
    pub view_sigma_m: f64,
    pub latitude_rad: f64,
    pub longitude_rad: f64,
    pub height_m: f64,
    pub name: [c_char; 64],
}
impl Default for odo_anchor {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}
#[repr(C)]
#[derive(Clone, Copy)]
pub struct odo_terrain {
    pub struct_size: u32,
    pub reserved: u32,
    pub user: *mut c_void,
    pub height: Option<unsafe extern "C" fn(*mut c_void, f64, f64, f64, *mut f64, *mut f64) -> i32>,
}
impl Default for odo_terrain {
    fn default() -> Self {
        unsafe { std::mem::zeroed() }
    }
}

pub type odo_plugin_entry = unsafe extern "C" fn(host: *const odo_host, out: *mut odo_plugin) -> i32;
pub type odo_callback = unsafe extern "C" fn(user: *mut c_void, event: *const odo_header);

/// Exports a [`plugin::Plugin`](crate::plugin::Plugin) as the plugin of this library.
#[macro_export]
macro_rules! plugin {
    ($kind:ty) => {
        #[export_name = "odo_plugin_entry_v1"]
        pub unsafe extern "C" fn odograph_plugin_entry(host: *const $crate::abi::odo_host, out: *mut $crate::abi::odo_plugin) -> i32 {
            static TABLE: $crate::plugin::Table = $crate::plugin::Table::new();
            TABLE.fill::<$kind>(host, out)
        }
    };
}

#[cfg(feature = "app")]
#[link(name = "odograph")]
extern "C" {
    pub fn odo_session_create(options: *const odo_session_options, session: *mut *mut odo_session, error: *mut odo_error) -> i32;
    pub fn odo_session_destroy(session: *mut odo_session);
    pub fn odo_session_push(session: *mut odo_session, sample: *const odo_header) -> i32;
    pub fn odo_session_push_imu(session: *mut odo_session, t_ns: i64, gyro_b: *const f64, accel_b: *const f64) -> i32;
    pub fn odo_session_flush(session: *mut odo_session) -> i32;
    pub fn odo_session_get_pose(session: *mut odo_session, t_ns: i64, pose: *mut odo_pose) -> i32;
    pub fn odo_session_get_pose_of(session: *mut odo_session, of: u32, world: u32, t_ns: i64, pose: *mut odo_pose) -> i32;
    pub fn odo_session_get_smooth_pose(session: *mut odo_session, t_ns: i64, pose: *mut odo_pose) -> i32;
    pub fn odo_session_set_callback(session: *mut odo_session, types: *const u32, count: u32, callback: Option<odo_callback>, user: *mut c_void) -> i32;
    pub fn odo_register_plugin(entry: Option<odo_plugin_entry>, error: *mut odo_error) -> i32;
    pub fn odo_current_plugin_call(text: *mut c_char, capacity: u64) -> u64;
    pub fn odo_session_get_statistics(session: *mut odo_session, statistics: *mut odo_statistics) -> i32;
    pub fn odo_session_last_error(session: *mut odo_session, error: *mut odo_error) -> i32;
    pub fn odo_session_to_geodetic(session: *mut odo_session, p_n: *const f64, geodetic: *mut f64) -> i32;
    pub fn odo_session_from_geodetic(session: *mut odo_session, geodetic: *const f64, p_n: *mut f64) -> i32;
    pub fn odo_session_save(session: *mut odo_session, data: *mut c_void, capacity: u64) -> i64;
    pub fn odo_session_load(session: *mut odo_session, data: *const c_void, size: u64) -> i32;
    pub fn odo_version() -> *const c_char;
    pub fn odo_abi_version() -> u32;
    pub fn odo_status_text(status: i32) -> *const c_char;
    pub fn odo_state_text(state: u32) -> *const c_char;
    pub fn odo_reason_text(reason: u32) -> *const c_char;
    pub fn odo_mode_text(mode: u32) -> *const c_char;
    pub fn odo_anchor_create(session: *mut odo_session, place: *const odo_anchor_place, id: *mut u64) -> i32;
    pub fn odo_anchor_get(session: *mut odo_session, id: u64, world: u32, t_ns: i64, anchor: *mut odo_anchor) -> i32;
    pub fn odo_anchor_list(session: *mut odo_session, ids: *mut u64, capacity: u64) -> i64;
    pub fn odo_anchor_remove(session: *mut odo_session, id: u64) -> i32;
    pub fn odo_recording_open(path: *const odo_string, recording: *mut *mut odo_recording, error: *mut odo_error) -> i32;
    pub fn odo_recording_next(recording: *mut odo_recording, message: *const *const odo_header, picture: *const *const c_void, picture_size: *mut u64) -> i32;
    pub fn odo_recording_loss(recording: *mut odo_recording, loss: *mut odo_error) -> i32;
    pub fn odo_recording_close(recording: *mut odo_recording);
    pub fn odo_recorder_create(path: *const odo_string, recorder: *mut *mut odo_recorder, error: *mut odo_error) -> i32;
    pub fn odo_recorder_write(recorder: *mut odo_recorder, message: *const odo_header, picture: *const c_void, picture_size: u64) -> i32;
    pub fn odo_recorder_close(recorder: *mut odo_recorder) -> i32;
}

unsafe impl Message for odo_imu {
    const TYPE: u32 = 0x1;
}
unsafe impl Message for odo_magnetometer {
    const TYPE: u32 = 0x2;
}
unsafe impl Message for odo_barometer {
    const TYPE: u32 = 0x3;
}
unsafe impl Message for odo_gnss {
    const TYPE: u32 = 0x4;
}
unsafe impl Message for odo_calibration {
    const TYPE: u32 = 0x5;
}
unsafe impl Message for odo_imu_noise {
    const TYPE: u32 = 0x6;
}
unsafe impl Message for odo_waypoint {
    const TYPE: u32 = 0x7;
}
unsafe impl Message for odo_earth_field {
    const TYPE: u32 = 0x8;
}
unsafe impl Message for odo_platform_pose {
    const TYPE: u32 = 0x9;
}
unsafe impl Message for odo_range {
    const TYPE: u32 = 0xa;
}
unsafe impl Message for odo_system_step {
    const TYPE: u32 = 0xb;
}
unsafe impl Message for odo_frame {
    const TYPE: u32 = 0x801;
}
unsafe impl Message for odo_attitude {
    const TYPE: u32 = 0x1001;
}
unsafe impl Message for odo_step {
    const TYPE: u32 = 0x1002;
}
unsafe impl Message for odo_motion_mode {
    const TYPE: u32 = 0x1003;
}
unsafe impl Message for odo_vo_motion {
    const TYPE: u32 = 0x1004;
}
unsafe impl Message for odo_scale {
    const TYPE: u32 = 0x1005;
}
unsafe impl Message for odo_fix {
    const TYPE: u32 = 0x1006;
}
unsafe impl Message for odo_pose {
    const TYPE: u32 = 0x1007;
}
unsafe impl Message for odo_state {
    const TYPE: u32 = 0x1008;
}
unsafe impl Message for odo_correction {
    const TYPE: u32 = 0x1009;
}
unsafe impl Message for odo_report {
    const TYPE: u32 = 0x100a;
}
unsafe impl Message for odo_refined {
    const TYPE: u32 = 0x100b;
}
unsafe impl Message for odo_relative_pose {
    const TYPE: u32 = 0x100c;
}

pub type Imu = odo_imu;
pub type Magnetometer = odo_magnetometer;
pub type Barometer = odo_barometer;
pub type Gnss = odo_gnss;
pub type Calibration = odo_calibration;
pub type ImuNoise = odo_imu_noise;
pub type Waypoint = odo_waypoint;
pub type EarthField = odo_earth_field;
pub type PlatformPose = odo_platform_pose;
pub type Range = odo_range;
pub type SystemStep = odo_system_step;
pub type Frame = odo_frame;
pub type Attitude = odo_attitude;
pub type Step = odo_step;
pub type MotionMode = odo_motion_mode;
pub type VoMotion = odo_vo_motion;
pub type Scale = odo_scale;
pub type Fix = odo_fix;
pub type Pose = odo_pose;
pub type State = odo_state;
pub type Correction = odo_correction;
pub type Report = odo_report;
pub type Refined = odo_refined;
pub type RelativePose = odo_relative_pose;
pub type SessionOptions = odo_session_options;
pub type Statistics = odo_statistics;
pub type AnchorPlace = odo_anchor_place;
pub type Anchor = odo_anchor;
