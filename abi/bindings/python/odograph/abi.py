# SPDX-License-Identifier: Apache-2.0
# Written by abi/generate.py; do not edit.
"""The C ABI of Odograph for ctypes: constants and structs with their C names; `load` declares the library's functions."""
# pylint: disable=missing-class-docstring, multiple-statements
import ctypes as c

_P = c.POINTER
_u8, _i32, _u32, _i64, _u64 = c.c_uint8, c.c_int32, c.c_uint32, c.c_int64, c.c_uint64
_f32, _f64, _char = c.c_float, c.c_double, c.c_char

def _pointer(name, kind):
    """Fields of a pointer, which has 8 bytes on every target."""
    return [(name, kind)] if c.sizeof(c.c_void_p) == 8 else [(name, kind), (name + "_bits", c.c_uint32)]


ODO_ABI_MAJOR = 1
ODO_ABI_MINOR = 0
ODO_OK = 0
ODO_NOT_READY = 1
ODO_END = 2
ODO_PARTIAL = 3
ODO_E_ARGUMENT = -1
ODO_E_DISCARD = -2
ODO_E_EXHAUSTED = -3
ODO_E_UNSUPPORTED = -4
ODO_E_STRUCT_SIZE = -5
ODO_E_VERSION = -6
ODO_E_STATE = -7
ODO_E_CONFIG = -8
ODO_E_NOT_FOUND = -9
ODO_E_DATA = -10
ODO_E_IO = -11
ODO_E_MEMORY = -1001
ODO_E_ERROR = -1002
ODO_E_FATAL = -2001
ODO_BORROWED = 2048
ODO_TYPE_IMU = 1
ODO_TYPE_MAGNETOMETER = 2
ODO_TYPE_BAROMETER = 3
ODO_TYPE_GNSS = 4
ODO_TYPE_CALIBRATION = 5
ODO_TYPE_IMU_NOISE = 6
ODO_TYPE_WAYPOINT = 7
ODO_TYPE_EARTH_FIELD = 8
ODO_TYPE_PLATFORM_POSE = 9
ODO_TYPE_RANGE = 10
ODO_TYPE_SYSTEM_STEP = 11
ODO_TYPE_FRAME = 2049
ODO_TYPE_ATTITUDE = 0x1001
ODO_TYPE_STEP = 0x1002
ODO_TYPE_MOTION_MODE = 0x1003
ODO_TYPE_VO_MOTION = 0x1004
ODO_TYPE_SCALE = 0x1005
ODO_TYPE_FIX = 0x1006
ODO_TYPE_POSE = 0x1007
ODO_TYPE_STATE = 0x1008
ODO_TYPE_CORRECTION = 0x1009
ODO_TYPE_REPORT = 0x100a
ODO_TYPE_REFINED = 0x100b
ODO_TYPE_RELATIVE_POSE = 0x100c
ODO_VENDOR_EVENT = 1024
ODO_LARGEST_MESSAGE = 0x10000
ODO_FLAG_QUALITY = 0x80000000
ODO_FLAG_DESCRIPTION = 0x10000000
ODO_FLAG_HOST_MASK = 0xf000000
ODO_FLAG_ACCEPTED = 0x1000000
ODO_FLAG_NAVIGATION = 0x2000000
ODO_NATIVE_HARDWARE_BUFFER = "android.hardware_buffer/1"
ODO_NATIVE_PIXEL_BUFFER = "apple.pixel_buffer/1"
ODO_ATTITUDE_MAGNETIC_NORTH = 1
ODO_ATTITUDE_MAG_DISTURBED = 2
ODO_ATTITUDE_REST = 4
ODO_ATTITUDE_TRUE_NORTH = 8
ODO_ATTITUDE_COVARIANCE = 16
ODO_ATTITUDE_GYRO_BIAS = 32
ODO_MODE_UNKNOWN = 0
ODO_MODE_STATIC = 1
ODO_MODE_WALKING_TEXTING = 2
ODO_MODE_WALKING_SWINGING = 3
ODO_MODE_WALKING_POCKET = 4
ODO_MODE_STAIRS = 5
ODO_MODE_RUNNING = 6
ODO_MODE_HANDLING = 7
ODO_STEP_HEADING = 1
ODO_STEP_HEADING_SIGMA = 2
ODO_TRACKING = 1
ODO_DEGRADED = 2
ODO_LOST = 3
ODO_REASON_NONE = 0
ODO_REASON_INITIALISING = 1
ODO_REASON_TOO_DARK = 2
ODO_REASON_TOO_FAST = 3
ODO_REASON_FEW_FEATURES = 4
ODO_REASON_NO_PARALLAX = 5
ODO_REASON_NO_STEPS = 6
ODO_REASON_SENSOR_SILENT = 7
ODO_REASON_PLUGIN_FAILED = 8
ODO_REASON_NO_SCALE = 9
ODO_VO_ROTATION = 1
ODO_VO_TRANSLATION = 2
ODO_VO_COVARIANCE = 4
ODO_VO_METRIC = 8
ODO_VO_INERTIAL = 16
ODO_SCALE_HORIZONTAL = 1
ODO_SCALE_STEADY = 2
ODO_SCALE_NOT_BY_STEPS = 4
ODO_FIX_NORTH = 1
ODO_FIX_EAST = 2
ODO_FIX_DOWN = 4
ODO_FIX_YAW = 8
ODO_FIX_ORIENTATION = 16
ODO_FIX_GEODETIC = 32
ODO_FIX_SLANT = 64
ODO_FIX_COVARIANCE = 128
ODO_FIX_ORIENTATION_COVARIANCE = 256
ODO_FIX_INTEGRITY = 512
ODO_FIX_LEVER = 1024
ODO_FIX_CROSS_COVARIANCE = 2048
ODO_FIX_SLANT_SIGMA = 0x1000
ODO_RELATIVE_POSE_TRANSLATION = 1
ODO_RELATIVE_POSE_ROTATION = 2
ODO_POSE_ORIENTATION = 1
ODO_POSE_POSITION = 2
ODO_POSE_VELOCITY = 4
ODO_POSE_METRIC = 8
ODO_POSE_CAMERA = 16
ODO_POSE_EXTRAPOLATED = 32
ODO_POSE_ANGULAR_VELOCITY = 64
ODO_POSE_VELOCITY_COVARIANCE = 128
ODO_POSE_COVARIANCE = 256
ODO_POSE_NORTH = 512
ODO_POSE_FLOOR = 1024
ODO_POSE_CARRIED = 2048
ODO_CORRECTION_FIX = 1
ODO_CORRECTION_SCALE = 2
ODO_CORRECTION_RECOVERED = 3
ODO_CORRECTION_RESTART = 4
ODO_REFINED_EXTRINSICS = 1
ODO_REFINED_TIME_OFFSET = 2
ODO_REFINED_LINE_TIME = 4
ODO_SEVERITY_DEBUG = 0
ODO_SEVERITY_INFO = 1
ODO_SEVERITY_WARNING = 2
ODO_SEVERITY_ERROR = 3
ODO_IMU_GYRO = 1
ODO_IMU_ACCEL = 2
ODO_IMU_GYRO_CORRECTED = 4
ODO_IMU_ACCEL_CORRECTED = 8
ODO_MAGNETOMETER_SIGMA = 1
ODO_MAGNETOMETER_CORRECTED = 2
ODO_BAROMETER_SIGMA = 1
ODO_GNSS_POSITION = 1
ODO_GNSS_HEIGHT = 2
ODO_GNSS_COVARIANCE = 4
ODO_GNSS_VELOCITY = 8
ODO_GNSS_LEVER = 16
ODO_FORMAT_GREY8 = 1
ODO_FORMAT_NV12 = 2
ODO_FORMAT_NV21 = 3
ODO_FORMAT_RGB8 = 4
ODO_FORMAT_RGBA8 = 5
ODO_FORMAT_YUV420 = 6
ODO_FORMAT_BGRA8 = 7
ODO_FRAME_EXPOSURE = 1
ODO_FRAME_LINE_TIME = 2
ODO_FRAME_MASK = 4
ODO_FRAME_INTRINSICS = 8
ODO_CAMERA_PINHOLE = 1
ODO_CAMERA_KANNALA_BRANDT = 2
ODO_CALIBRATION_EXTRINSICS = 1
ODO_CALIBRATION_TIME_OFFSET = 2
ODO_CALIBRATION_LINE_TIME = 4
ODO_WAYPOINT_VERTICAL = 1
ODO_WAYPOINT_LEVER = 2
ODO_EARTH_FIELD_DECLINATION = 1
ODO_EARTH_FIELD_INCLINATION = 2
ODO_EARTH_FIELD_INTENSITY = 4
ODO_PLATFORM_POSE_CAMERA = 1
ODO_PLATFORM_POSE_COVARIANCE = 2
ODO_RANGE_TRANSMITTER = 1
ODO_RANGE_LEVER = 2
ODO_SYSTEM_STEP_COUNT = 1
ODO_SYSTEM_STEP_DISTANCE = 2
ODO_SERVICE_REPORT = "odo.report/1"
ODO_SERVICE_RANDOM = "odo.random/1"
ODO_SERVICE_ASSETS = "odo.assets/1"
ODO_SERVICE_CONTENTS = "odo.contents/1"
ODO_SERVICE_WAKE = "odo.wake/1"
ODO_PARAMETER_BOOL = 1
ODO_PARAMETER_INT = 2
ODO_PARAMETER_REAL = 3
ODO_PARAMETER_STRING = 4
ODO_PARAMETER_CHOICE = 5
ODO_PARAMETER_REALS = 6
ODO_LARGEST_STATE = 0x1000000
ODO_PLUGIN_SEVERAL_CAMERAS = 1
ODO_PLUGIN_NATIVE_FRAMES = 2
ODO_PLUGIN_ENTRY_SYMBOL = "odo_plugin_entry_v1"
ODO_INTERFACE_ABSOLUTE_FIXER = "odo.absolute_fixer/1"
ODO_RUN_LIVE = 0
ODO_RUN_REPLAY = 1
ODO_SESSION_CRASH_NOTES = 1
ODO_TIME_LATEST = -0x8000000000000000
ODO_WORLD_CORRECTED = 0
ODO_WORLD_SMOOTH = 1
ODO_OF_PIPELINE = 0
ODO_OF_BODY = 1
ODO_OF_CAMERA = 2
ODO_ALL_EVENTS = 0xffffffff
ODO_ANCHOR_POSE = 1
ODO_ANCHOR_VIEW = 2
ODO_ANCHOR_GEODETIC = 3
ODO_HEIGHT_ELLIPSOID = 1
ODO_HEIGHT_GEOID = 2
ODO_HEIGHT_TERRAIN = 3
ODO_ANCHOR_PLACED = 1
ODO_ANCHOR_VIEW_POSE = 2
ODO_ANCHOR_ON_EARTH = 4
ODO_ANCHOR_IN_FRONT = 8
ODO_REASON_NO_FIX = 10
ODO_REASON_NO_GROUND = 11
ODO_REASON_NO_ORIGIN = 12
ODO_INTERFACE_ATTITUDE = "odo.attitude/1"
ODO_LARGEST_PICTURE = 0x4000000
ODO_INTERFACE_SCALE_SOURCE = "odo.scale_source/1"
ODO_INTERFACE_STEP_ESTIMATOR = "odo.step_estimator/1"
ODO_EXTENSION_TERRAIN = "odo.terrain/1"
ODO_INTERFACE_VO_FRONTEND = "odo.vo_frontend/1"


class odo_asset(c.Structure): pass
class odo_instance(c.Structure): pass
class odo_session(c.Structure): pass
class odo_recording(c.Structure): pass
class odo_recorder(c.Structure): pass
class odo_string(c.Structure): _fields_ = [*_pointer("data", _P(_char)), ("size", _u64)]
class odo_header(c.Structure): _fields_ = [("struct_size", _u32), ("type", _u32), ("t_ns", _i64), ("source", _u32),
    ("flags", _u32), ("quality", _f32), ("reserved", _u32)]


class Message(c.Structure):
    """A message. Header fields are also attributes of it. Fields without an argument are zero; arrays accept sequences of their length."""
    TYPE = 0
    picture = None  # encoded picture of a recorded frame, PNG or JPEG
    HEAD = ("t_ns", "source", "flags", "quality")

    def __init__(self, **fields):
        super().__init__()
        self.header.struct_size, self.header.type = c.sizeof(self), self.TYPE
        for name, value in fields.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        if name in self.HEAD:
            setattr(self.header, name, value)
        elif isinstance(getattr(self, name), c.Array) and not isinstance(value, (bytes, c.Array)):
            getattr(self, name)[:] = value
        else:
            super().__setattr__(name, value)

    def __getattr__(self, name):
        if name in self.HEAD:
            return getattr(self.header, name)
        raise AttributeError(f"{type(self).__name__} has no field '{name}'; it has {', '.join(f[0] for f in self._fields_)}")


class odo_loan(c.Structure): _fields_ = [*_pointer("owner", c.c_void_p),
    *_pointer("retain", c.CFUNCTYPE(_i32, c.c_void_p)), *_pointer("release", c.CFUNCTYPE(None, c.c_void_p)),
    *_pointer("native", c.CFUNCTYPE(c.c_void_p, c.c_void_p, _P(_char), _u64)), ("reserved", _u64)]
class odo_borrowed(c.Structure): _fields_ = [("header", odo_header), ("loan", odo_loan)]
class odo_attitude(Message): TYPE = 0x1001; _fields_ = [("header", odo_header), ("q_n_b", _f64 * 4),
    ("covariance_n", _f64 * 9), ("gyro_bias_b", _f64 * 3)]
class odo_step(Message): TYPE = 0x1002; _fields_ = [("header", odo_header), ("t_start_ns", _i64), ("t_end_ns", _i64),
    ("length_m", _f64), ("sigma_m", _f64), ("frequency_hz", _f64), ("heading_rad", _f64), ("mode", _u32),
    ("index", _u32), ("heading_sigma_rad", _f64)]
class odo_motion_mode(Message): TYPE = 0x1003; _fields_ = [("header", odo_header), ("mode", _u32), ("reserved", _u32)]
class odo_vo_motion(Message): TYPE = 0x1004; _fields_ = [("header", odo_header), ("t_from_ns", _i64),
    ("q_c0_c1", _f64 * 4), ("p_c0_c1", _f64 * 3), ("covariance", _f64 * 36), ("q_n_c0", _f64 * 4), ("camera", _u32),
    ("state", _u32), ("reason", _u32), ("scale_group", _u32), ("tracked", _u32), ("inliers", _u32),
    ("scale_sigma", _f64), ("velocity_c1", _f64 * 3), ("gravity_c1", _f64 * 3), ("gyro_bias_b", _f64 * 3),
    ("accel_bias_b", _f64 * 3)]
class odo_scale(Message): TYPE = 0x1005; _fields_ = [("header", odo_header), ("valid_from_ns", _i64),
    ("valid_to_ns", _i64), ("scale", _f64), ("sigma", _f64), ("displacement_m", _f64), ("scale_group", _u32),
    ("reserved", _u32)]
class odo_fix(Message): TYPE = 0x1006; _fields_ = [("header", odo_header), ("p_n", _f64 * 3),
    ("covariance_n", _f64 * 9), ("q_n_b", _f64 * 4), ("orientation_cov_n", _f64 * 9), ("yaw_rad", _f64),
    ("yaw_sigma_rad", _f64), ("latitude_rad", _f64), ("longitude_rad", _f64), ("height_m", _f64), ("integrity", _f64),
    ("landmark_n", _f64 * 3), ("slant_distance_m", _f64), ("lever_b", _f64 * 3), ("yaw_axis_b", _f64 * 3),
    ("cross_covariance_n", _f64 * 9), ("slant_sigma_m", _f64)]
class odo_relative_pose(Message): TYPE = 0x100c; _fields_ = [("header", odo_header), ("t_from_ns", _i64),
    ("q_b0_b1", _f64 * 4), ("p_b0_b1", _f64 * 3), ("covariance", _f64 * 36)]
class odo_pose(Message): TYPE = 0x1007; _fields_ = [("header", odo_header), ("q_n", _f64 * 4), ("p_n", _f64 * 3),
    ("velocity_n", _f64 * 3), ("covariance", _f64 * 36), ("scale", _f64), ("scale_sigma", _f64), ("distance_m", _f64),
    ("state", _u32), ("reason", _u32), ("angular_velocity", _f64 * 3), ("velocity_covariance", _f64 * 9),
    ("floor", _i32), ("reserved", _u32), ("floor_probability", _f64)]
class odo_state(Message): TYPE = 0x1008; _fields_ = [("header", odo_header), ("state", _u32), ("reason", _u32)]
class odo_correction(Message): TYPE = 0x1009; _fields_ = [("header", odo_header), ("q_n", _f64 * 4), ("p_n", _f64 * 3),
    ("reason", _u32), ("reserved", _u32)]
class odo_refined(Message): TYPE = 0x100b; _fields_ = [("header", odo_header), ("camera", _u32), ("model", _u32),
    ("width", _u32), ("height", _u32), ("distortion_count", _u32), ("reserved", _u32), ("fx", _f64), ("fy", _f64),
    ("cx", _f64), ("cy", _f64), ("distortion", _f64 * 8), ("q_b_c", _f64 * 4), ("p_b_c", _f64 * 3),
    ("time_offset_ns", _i64), ("line_time_ns", _i64)]
class odo_report(Message): TYPE = 0x100a; _fields_ = [("header", odo_header), ("count", _u64), ("severity", _u32),
    ("status", _i32), ("plugin", _char * 64), ("key", _char * 64), ("text", _char * 1024)]
class odo_imu(Message): TYPE = 0x1; _fields_ = [("header", odo_header), ("gyro_b", _f64 * 3), ("accel_b", _f64 * 3)]
class odo_magnetometer(Message): TYPE = 0x2; _fields_ = [("header", odo_header), ("field_b", _f64 * 3),
    ("sigma_t", _f64)]
class odo_barometer(Message): TYPE = 0x3; _fields_ = [("header", odo_header), ("pressure_pa", _f64),
    ("sigma_pa", _f64)]
class odo_gnss(Message): TYPE = 0x4; _fields_ = [("header", odo_header), ("latitude_rad", _f64),
    ("longitude_rad", _f64), ("height_m", _f64), ("covariance_n", _f64 * 9), ("velocity_n", _f64 * 3),
    ("satellites", _u32), ("reserved", _u32), ("lever_b", _f64 * 3)]
class odo_plane(c.Structure): _fields_ = [*_pointer("data", _P(_u8)), ("row_stride", _i64), ("pixel_stride", _u32),
    ("rows", _u32)]
class odo_frame(Message): TYPE = 0x801; _fields_ = [("header", odo_header), ("loan", odo_loan), ("format", _u32),
    ("width", _u32), ("height", _u32), ("plane_count", _u32), ("planes", odo_plane * 4), ("mask", odo_plane),
    ("exposure_ns", _i64), ("line_time_ns", _i64), ("fx", _f64), ("fy", _f64), ("cx", _f64), ("cy", _f64)]
class odo_calibration(Message): TYPE = 0x5; _fields_ = [("header", odo_header), ("model", _u32), ("width", _u32),
    ("height", _u32), ("distortion_count", _u32), ("fx", _f64), ("fy", _f64), ("cx", _f64), ("cy", _f64),
    ("distortion", _f64 * 8), ("q_b_c", _f64 * 4), ("p_b_c", _f64 * 3), ("time_offset_ns", _i64),
    ("line_time_ns", _i64)]
class odo_imu_noise(Message): TYPE = 0x6; _fields_ = [("header", odo_header), ("gyro_noise", _f64),
    ("gyro_walk", _f64), ("accel_noise", _f64), ("accel_walk", _f64)]
class odo_waypoint(Message): TYPE = 0x7; _fields_ = [("header", odo_header), ("p_n", _f64 * 3), ("sigma_m", _f64),
    ("lever_b", _f64 * 3)]
class odo_earth_field(Message): TYPE = 0x8; _fields_ = [("header", odo_header), ("declination_rad", _f64),
    ("inclination_rad", _f64), ("intensity_t", _f64)]
class odo_platform_pose(Message): TYPE = 0x9; _fields_ = [("header", odo_header), ("q_w", _f64 * 4), ("p_w", _f64 * 3),
    ("covariance", _f64 * 36), ("state", _u32), ("world", _u32)]
class odo_range(Message): TYPE = 0xa; _fields_ = [("header", odo_header), ("transmitter", _u64), ("range_m", _f64),
    ("sigma_m", _f64), ("p_n", _f64 * 3), ("transmitter_sigma_m", _f64), ("lever_b", _f64 * 3)]
class odo_system_step(Message): TYPE = 0xb; _fields_ = [("header", odo_header), ("count", _u64), ("distance_m", _f64)]
class odo_host(c.Structure): pass
odo_host._fields_ = [("struct_size", _u32), ("abi_major_min", _u32), ("abi_major_max", _u32), ("abi_minor", _u32),
    ("version", odo_string), *_pointer("get_service", c.CFUNCTYPE(c.c_void_p, _P(odo_host), _P(_char), _u64))]
class odo_report_service(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32),
    *_pointer("report", c.CFUNCTYPE(None, _P(odo_host), _u32, _u32, _P(odo_string), _P(odo_string)))]
class odo_random_service(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32),
    *_pointer("seed", c.CFUNCTYPE(_u64, _P(odo_host), _u32, _u64))]
class odo_asset_service(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32),
    *_pointer("resolve", c.CFUNCTYPE(_i64, _P(odo_host), _P(odo_string), _P(_char), _u64))]
class odo_content_service(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32),
    *_pointer("user", c.c_void_p),
    *_pointer("open", c.CFUNCTYPE(_i32, c.c_void_p, _P(odo_string), _P(_P(odo_asset)), _P(_u64))),
    *_pointer("read", c.CFUNCTYPE(_i64, _P(odo_asset), _u64, c.c_void_p, _u64)),
    *_pointer("close", c.CFUNCTYPE(None, _P(odo_asset)))]
class odo_wake_service(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32),
    *_pointer("wake", c.CFUNCTYPE(None, _P(odo_host), _u32))]
class odo_parameter(c.Structure): _fields_ = [("struct_size", _u32), ("type", _u32), ("name", odo_string),
    ("unit", odo_string), ("help", odo_string), ("default_text", odo_string), ("choices", odo_string), ("min", _f64),
    ("max", _f64), ("count", _u32), ("reserved", _u32)]
class odo_value(c.Structure): _fields_ = [("struct_size", _u32), ("type", _u32), ("name", odo_string),
    ("text", odo_string), *_pointer("reals", _P(_f64)), ("count", _u64), ("integer", _i64)]
class odo_batch(c.Structure): _fields_ = [("struct_size", _u32), ("count", _u32),
    *_pointer("messages", _P(_P(odo_header)))]
class odo_sink(c.Structure): pass
odo_sink._fields_ = [("struct_size", _u32), ("instance", _u32),
    *_pointer("emit", c.CFUNCTYPE(_i32, _P(odo_sink), _P(odo_header)))]
class odo_plugin(c.Structure): _fields_ = [("struct_size", _u32), ("abi_major", _u32), ("abi_minor", _u32),
    ("interface_count", _u32), *_pointer("interfaces", _P(odo_string)), ("id", odo_string), ("version", odo_string),
    ("summary", odo_string), ("refusal", odo_string), *_pointer("parameters", _P(odo_parameter)),
    ("parameter_count", _u32), ("parameter_stride", _u32), ("flags", _u32), ("reserved", _u32),
    *_pointer("create", c.CFUNCTYPE(_i32, _P(odo_host), _u32, _P(odo_string), _P(_P(odo_instance)))),
    *_pointer("configure", c.CFUNCTYPE(_i32, _P(odo_instance), _P(odo_value), _u32, _u32)),
    *_pointer("activate", c.CFUNCTYPE(_i32, _P(odo_instance), _P(odo_sink))),
    *_pointer("process", c.CFUNCTYPE(_i32, _P(odo_instance), _P(odo_batch))),
    *_pointer("destroy", c.CFUNCTYPE(None, _P(odo_instance))), *_pointer("reset", c.CFUNCTYPE(_i32, _P(odo_instance))),
    *_pointer("save", c.CFUNCTYPE(_i64, _P(odo_instance), c.c_void_p, _u64)),
    *_pointer("load", c.CFUNCTYPE(_i32, _P(odo_instance), c.c_void_p, _u64)),
    *_pointer("get_interface", c.CFUNCTYPE(c.c_void_p, _P(odo_instance), _P(_char), _u64)),
    *_pointer("inputs", _P(_u32)), *_pointer("outputs", _P(_u32)), ("input_count", _u32), ("output_count", _u32)]
class odo_error(c.Structure): _fields_ = [("struct_size", _u32), ("status", _i32), ("message", _char * 2040)]
class odo_session_options(c.Structure): _fields_ = [("struct_size", _u32), ("run", _u32), ("config_path", odo_string),
    ("config_text", odo_string), ("plugin_path", odo_string), ("seed", _u64), ("asset_path", odo_string),
    ("flags", _u32), ("reserved", _u32), *_pointer("user", c.c_void_p),
    *_pointer("get_service", c.CFUNCTYPE(c.c_void_p, c.c_void_p, _P(_char), _u64))]
class odo_statistics(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32), ("pushed", _u64),
    ("processed", _u64), ("frames", _u64), ("steps", _u64), ("fixes_accepted", _u64), ("fixes_rejected", _u64),
    ("late", _u64), ("duplicate", _u64), ("invalid", _u64), ("overflow", _u64), ("gaps", _u64),
    ("plugin_faults", _u64), ("tracking_s", _f64), ("degraded_s", _f64), ("lost_s", _f64), ("distance_m", _f64),
    ("wild", _u64), ("events_dropped", _u64), ("unknown", _u64), ("scale_sigma", _f64), ("scale_by_inertia", _f64),
    ("scale_by_steps", _f64)]
class odo_anchor_place(c.Structure): _fields_ = [("struct_size", _u32), ("kind", _u32), ("t_ns", _i64),
    ("world", _u32), ("height_above", _u32), ("q", _f64 * 4), ("p", _f64 * 3), ("latitude_rad", _f64),
    ("longitude_rad", _f64), ("height_m", _f64), ("geoid_height_m", _f64), ("sigma_m", _f64), ("name", odo_string)]
class odo_anchor(c.Structure): _fields_ = [("struct_size", _u32), ("kind", _u32), ("id", _u64), ("t_ns", _i64),
    ("flags", _u32), ("state", _u32), ("reason", _u32), ("reserved", _u32), ("q_n", _f64 * 4), ("p_n", _f64 * 3),
    ("q_view", _f64 * 4), ("p_view", _f64 * 3), ("position_sigma_m", _f64), ("yaw_sigma_rad", _f64),
    ("view_sigma_m", _f64), ("latitude_rad", _f64), ("longitude_rad", _f64), ("height_m", _f64), ("name", _char * 64)]
class odo_terrain(c.Structure): _fields_ = [("struct_size", _u32), ("reserved", _u32), *_pointer("user", c.c_void_p),
    *_pointer("height", c.CFUNCTYPE(_i32, c.c_void_p, _f64, _f64, _f64, _P(_f64), _P(_f64)))]

Imu = odo_imu
Magnetometer = odo_magnetometer
Barometer = odo_barometer
Gnss = odo_gnss
Calibration = odo_calibration
ImuNoise = odo_imu_noise
Waypoint = odo_waypoint
EarthField = odo_earth_field
PlatformPose = odo_platform_pose
Range = odo_range
SystemStep = odo_system_step
Frame = odo_frame
Attitude = odo_attitude
Step = odo_step
MotionMode = odo_motion_mode
VoMotion = odo_vo_motion
Scale = odo_scale
Fix = odo_fix
Pose = odo_pose
State = odo_state
Correction = odo_correction
Report = odo_report
Refined = odo_refined
RelativePose = odo_relative_pose
SessionOptions = odo_session_options
Statistics = odo_statistics
AnchorPlace = odo_anchor_place
Anchor = odo_anchor

MESSAGES = {kind.TYPE: kind for kind in Message.__subclasses__()}

odo_plugin_entry = c.CFUNCTYPE(_i32, _P(odo_host), _P(odo_plugin))
odo_callback = c.CFUNCTYPE(None, c.c_void_p, _P(odo_header))

FUNCTIONS = {
    "odo_session_create": (_i32, [_P(odo_session_options), _P(_P(odo_session)), _P(odo_error)]),
    "odo_session_destroy": (None, [_P(odo_session)]),
    "odo_session_push": (_i32, [_P(odo_session), _P(odo_header)]),
    "odo_session_push_imu": (_i32, [_P(odo_session), _i64, _P(_f64), _P(_f64)]),
    "odo_session_flush": (_i32, [_P(odo_session)]),
    "odo_session_get_pose": (_i32, [_P(odo_session), _i64, _P(odo_pose)]),
    "odo_session_get_pose_of": (_i32, [_P(odo_session), _u32, _u32, _i64, _P(odo_pose)]),
    "odo_session_get_smooth_pose": (_i32, [_P(odo_session), _i64, _P(odo_pose)]),
    "odo_session_set_callback": (_i32, [_P(odo_session), _P(_u32), _u32, odo_callback, c.c_void_p]),
    "odo_register_plugin": (_i32, [odo_plugin_entry, _P(odo_error)]),
    "odo_current_plugin_call": (_u64, [_P(_char), _u64]),
    "odo_session_get_statistics": (_i32, [_P(odo_session), _P(odo_statistics)]),
    "odo_session_last_error": (_i32, [_P(odo_session), _P(odo_error)]),
    "odo_session_to_geodetic": (_i32, [_P(odo_session), _P(_f64), _P(_f64)]),
    "odo_session_from_geodetic": (_i32, [_P(odo_session), _P(_f64), _P(_f64)]),
    "odo_session_save": (_i64, [_P(odo_session), c.c_void_p, _u64]),
    "odo_session_load": (_i32, [_P(odo_session), c.c_void_p, _u64]),
    "odo_version": (c.c_char_p, []),
    "odo_abi_version": (_u32, []),
    "odo_status_text": (c.c_char_p, [_i32]),
    "odo_state_text": (c.c_char_p, [_u32]),
    "odo_reason_text": (c.c_char_p, [_u32]),
    "odo_mode_text": (c.c_char_p, [_u32]),
    "odo_anchor_create": (_i32, [_P(odo_session), _P(odo_anchor_place), _P(_u64)]),
    "odo_anchor_get": (_i32, [_P(odo_session), _u64, _u32, _i64, _P(odo_anchor)]),
    "odo_anchor_list": (_i64, [_P(odo_session), _P(_u64), _u64]),
    "odo_anchor_remove": (_i32, [_P(odo_session), _u64]),
    "odo_recording_open": (_i32, [_P(odo_string), _P(_P(odo_recording)), _P(odo_error)]),
    "odo_recording_next": (_i32, [_P(odo_recording), _P(_P(odo_header)), _P(c.c_void_p), _P(_u64)]),
    "odo_recording_loss": (_i32, [_P(odo_recording), _P(odo_error)]),
    "odo_recording_close": (None, [_P(odo_recording)]),
    "odo_recorder_create": (_i32, [_P(odo_string), _P(_P(odo_recorder)), _P(odo_error)]),
    "odo_recorder_write": (_i32, [_P(odo_recorder), _P(odo_header), c.c_void_p, _u64]),
    "odo_recorder_close": (_i32, [_P(odo_recorder)]),
}


def load(path):
    """Loads the library and declares its functions. An older library may lack some of them."""
    library = c.CDLL(path)
    for name, (result, parameters) in FUNCTIONS.items():
        if hasattr(library, name):
            function = getattr(library, name)
            function.restype, function.argtypes = result, parameters
    return library
