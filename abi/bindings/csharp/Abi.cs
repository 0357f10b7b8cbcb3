// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
using System;
using System.Runtime.InteropServices;

namespace Odograph {
  /// Constants under their C names, and the library's functions.
  public static unsafe class Abi {
    public const string Library = "odograph";

    public const uint ODO_ABI_MAJOR = 1;
    public const uint ODO_ABI_MINOR = 0;
    public const int ODO_OK = 0;
    public const int ODO_NOT_READY = 1;
    public const int ODO_END = 2;
    public const int ODO_PARTIAL = 3;
    public const int ODO_E_ARGUMENT = -1;
    public const int ODO_E_DISCARD = -2;
    public const int ODO_E_EXHAUSTED = -3;
    public const int ODO_E_UNSUPPORTED = -4;
    public const int ODO_E_STRUCT_SIZE = -5;
    public const int ODO_E_VERSION = -6;
    public const int ODO_E_STATE = -7;
    public const int ODO_E_CONFIG = -8;
    public const int ODO_E_NOT_FOUND = -9;
    public const int ODO_E_DATA = -10;
    public const int ODO_E_IO = -11;
    public const int ODO_E_MEMORY = -1001;
    public const int ODO_E_ERROR = -1002;
    public const int ODO_E_FATAL = -2001;
    public const uint ODO_BORROWED = 2048;
    public const uint ODO_TYPE_IMU = 1;
    public const uint ODO_TYPE_MAGNETOMETER = 2;
    public const uint ODO_TYPE_BAROMETER = 3;
    public const uint ODO_TYPE_GNSS = 4;
    public const uint ODO_TYPE_CALIBRATION = 5;
    public const uint ODO_TYPE_IMU_NOISE = 6;
    public const uint ODO_TYPE_WAYPOINT = 7;
    public const uint ODO_TYPE_EARTH_FIELD = 8;
    public const uint ODO_TYPE_PLATFORM_POSE = 9;
    public const uint ODO_TYPE_RANGE = 10;
    public const uint ODO_TYPE_SYSTEM_STEP = 11;
    public const uint ODO_TYPE_FRAME = 2049;
    public const uint ODO_TYPE_ATTITUDE = 4097;
    public const uint ODO_TYPE_STEP = 4098;
    public const uint ODO_TYPE_MOTION_MODE = 4099;
    public const uint ODO_TYPE_VO_MOTION = 4100;
    public const uint ODO_TYPE_SCALE = 4101;
    public const uint ODO_TYPE_FIX = 4102;
    public const uint ODO_TYPE_POSE = 4103;
    public const uint ODO_TYPE_STATE = 4104;
    public const uint ODO_TYPE_CORRECTION = 4105;
    public const uint ODO_TYPE_REPORT = 4106;
    public const uint ODO_TYPE_REFINED = 4107;
    public const uint ODO_TYPE_RELATIVE_POSE = 4108;
    public const uint ODO_VENDOR_EVENT = 1024;
    public const uint ODO_LARGEST_MESSAGE = 65536;
    public const uint ODO_FLAG_QUALITY = 2147483648;
    public const uint ODO_FLAG_DESCRIPTION = 268435456;
    public const uint ODO_FLAG_HOST_MASK = 251658240;
    public const uint ODO_FLAG_ACCEPTED = 16777216;
    public const uint ODO_FLAG_NAVIGATION = 33554432;
    public const string ODO_NATIVE_HARDWARE_BUFFER = "android.hardware_buffer/1";
    public const string ODO_NATIVE_PIXEL_BUFFER = "apple.pixel_buffer/1";
    public const uint ODO_ATTITUDE_MAGNETIC_NORTH = 1;
    public const uint ODO_ATTITUDE_MAG_DISTURBED = 2;
    public const uint ODO_ATTITUDE_REST = 4;
    public const uint ODO_ATTITUDE_TRUE_NORTH = 8;
    public const uint ODO_ATTITUDE_COVARIANCE = 16;
    public const uint ODO_ATTITUDE_GYRO_BIAS = 32;
    public const uint ODO_MODE_UNKNOWN = 0;
    public const uint ODO_MODE_STATIC = 1;
    public const uint ODO_MODE_WALKING_TEXTING = 2;
    public const uint ODO_MODE_WALKING_SWINGING = 3;
    public const uint ODO_MODE_WALKING_POCKET = 4;
    public const uint ODO_MODE_STAIRS = 5;
    public const uint ODO_MODE_RUNNING = 6;
    public const uint ODO_MODE_HANDLING = 7;
    public const uint ODO_STEP_HEADING = 1;
    public const uint ODO_STEP_HEADING_SIGMA = 2;
    public const uint ODO_TRACKING = 1;
    public const uint ODO_DEGRADED = 2;
    public const uint ODO_LOST = 3;
    public const uint ODO_REASON_NONE = 0;
    public const uint ODO_REASON_INITIALISING = 1;
    public const uint ODO_REASON_TOO_DARK = 2;
    public const uint ODO_REASON_TOO_FAST = 3;
    public const uint ODO_REASON_FEW_FEATURES = 4;
    public const uint ODO_REASON_NO_PARALLAX = 5;
    public const uint ODO_REASON_NO_STEPS = 6;
    public const uint ODO_REASON_SENSOR_SILENT = 7;
    public const uint ODO_REASON_PLUGIN_FAILED = 8;
    public const uint ODO_REASON_NO_SCALE = 9;
    public const uint ODO_VO_ROTATION = 1;
    public const uint ODO_VO_TRANSLATION = 2;
    public const uint ODO_VO_COVARIANCE = 4;
    public const uint ODO_VO_METRIC = 8;
    public const uint ODO_VO_INERTIAL = 16;
    public const uint ODO_SCALE_HORIZONTAL = 1;
    public const uint ODO_SCALE_STEADY = 2;
    public const uint ODO_SCALE_NOT_BY_STEPS = 4;
    public const uint ODO_FIX_NORTH = 1;
    public const uint ODO_FIX_EAST = 2;
    public const uint ODO_FIX_DOWN = 4;
    public const uint ODO_FIX_YAW = 8;
    public const uint ODO_FIX_ORIENTATION = 16;
    public const uint ODO_FIX_GEODETIC = 32;
    public const uint ODO_FIX_SLANT = 64;
    public const uint ODO_FIX_COVARIANCE = 128;
    public const uint ODO_FIX_ORIENTATION_COVARIANCE = 256;
    public const uint ODO_FIX_INTEGRITY = 512;
    public const uint ODO_FIX_LEVER = 1024;
    public const uint ODO_FIX_CROSS_COVARIANCE = 2048;
    public const uint ODO_FIX_SLANT_SIGMA = 4096;
    public const uint ODO_RELATIVE_POSE_TRANSLATION = 1;
    public const uint ODO_RELATIVE_POSE_ROTATION = 2;
    public const uint ODO_POSE_ORIENTATION = 1;
    public const uint ODO_POSE_POSITION = 2;
    public const uint ODO_POSE_VELOCITY = 4;
    public const uint ODO_POSE_METRIC = 8;
    public const uint ODO_POSE_CAMERA = 16;
    public const uint ODO_POSE_EXTRAPOLATED = 32;
    public const uint ODO_POSE_ANGULAR_VELOCITY = 64;
    public const uint ODO_POSE_VELOCITY_COVARIANCE = 128;
    public const uint ODO_POSE_COVARIANCE = 256;
    public const uint ODO_POSE_NORTH = 512;
    public const uint ODO_POSE_FLOOR = 1024;
    public const uint ODO_POSE_CARRIED = 2048;
    public const uint ODO_CORRECTION_FIX = 1;
    public const uint ODO_CORRECTION_SCALE = 2;
    public const uint ODO_CORRECTION_RECOVERED = 3;
    public const uint ODO_CORRECTION_RESTART = 4;
    public const uint ODO_REFINED_EXTRINSICS = 1;
    public const uint ODO_REFINED_TIME_OFFSET = 2;
    public const uint ODO_REFINED_LINE_TIME = 4;
    public const uint ODO_SEVERITY_DEBUG = 0;
    public const uint ODO_SEVERITY_INFO = 1;
    public const uint ODO_SEVERITY_WARNING = 2;
    public const uint ODO_SEVERITY_ERROR = 3;
    public const uint ODO_IMU_GYRO = 1;
    public const uint ODO_IMU_ACCEL = 2;
    public const uint ODO_IMU_GYRO_CORRECTED = 4;
    public const uint ODO_IMU_ACCEL_CORRECTED = 8;
    public const uint ODO_MAGNETOMETER_SIGMA = 1;
    public const uint ODO_MAGNETOMETER_CORRECTED = 2;
    public const uint ODO_BAROMETER_SIGMA = 1;
    public const uint ODO_GNSS_POSITION = 1;
    public const uint ODO_GNSS_HEIGHT = 2;
    public const uint ODO_GNSS_COVARIANCE = 4;
    public const uint ODO_GNSS_VELOCITY = 8;
    public const uint ODO_GNSS_LEVER = 16;
    public const uint ODO_FORMAT_GREY8 = 1;
    public const uint ODO_FORMAT_NV12 = 2;
    public const uint ODO_FORMAT_NV21 = 3;
    public const uint ODO_FORMAT_RGB8 = 4;
    public const uint ODO_FORMAT_RGBA8 = 5;
    public const uint ODO_FORMAT_YUV420 = 6;
    public const uint ODO_FORMAT_BGRA8 = 7;
    public const uint ODO_FRAME_EXPOSURE = 1;
    public const uint ODO_FRAME_LINE_TIME = 2;
    public const uint ODO_FRAME_MASK = 4;
    public const uint ODO_FRAME_INTRINSICS = 8;
    public const uint ODO_CAMERA_PINHOLE = 1;
    public const uint ODO_CAMERA_KANNALA_BRANDT = 2;
    public const uint ODO_CALIBRATION_EXTRINSICS = 1;
    public const uint ODO_CALIBRATION_TIME_OFFSET = 2;
    public const uint ODO_CALIBRATION_LINE_TIME = 4;
    public const uint ODO_WAYPOINT_VERTICAL = 1;
    public const uint ODO_WAYPOINT_LEVER = 2;
    public const uint ODO_EARTH_FIELD_DECLINATION = 1;
    public const uint ODO_EARTH_FIELD_INCLINATION = 2;
    public const uint ODO_EARTH_FIELD_INTENSITY = 4;
    public const uint ODO_PLATFORM_POSE_CAMERA = 1;
    public const uint ODO_PLATFORM_POSE_COVARIANCE = 2;
    public const uint ODO_RANGE_TRANSMITTER = 1;
    public const uint ODO_RANGE_LEVER = 2;
    public const uint ODO_SYSTEM_STEP_COUNT = 1;
    public const uint ODO_SYSTEM_STEP_DISTANCE = 2;
    public const string ODO_SERVICE_REPORT = "odo.report/1";
    public const string ODO_SERVICE_RANDOM = "odo.random/1";
    public const string ODO_SERVICE_ASSETS = "odo.assets/1";
    public const string ODO_SERVICE_CONTENTS = "odo.contents/1";
    public const string ODO_SERVICE_WAKE = "odo.wake/1";
    public const uint ODO_PARAMETER_BOOL = 1;
    public const uint ODO_PARAMETER_INT = 2;
    public const uint ODO_PARAMETER_REAL = 3;
    public const uint ODO_PARAMETER_STRING = 4;
    public const uint ODO_PARAMETER_CHOICE = 5;
    public const uint ODO_PARAMETER_REALS = 6;
    public const uint ODO_LARGEST_STATE = 16777216;
    public const uint ODO_PLUGIN_SEVERAL_CAMERAS = 1;
    public const uint ODO_PLUGIN_NATIVE_FRAMES = 2;
    public const string ODO_PLUGIN_ENTRY_SYMBOL = "odo_plugin_entry_v1";
    public const string ODO_INTERFACE_ABSOLUTE_FIXER = "odo.absolute_fixer/1";
    public const uint ODO_RUN_LIVE = 0;
    public const uint ODO_RUN_REPLAY = 1;
    public const uint ODO_SESSION_CRASH_NOTES = 1;
    public const long ODO_TIME_LATEST = -9223372036854775808;
    public const uint ODO_WORLD_CORRECTED = 0;
    public const uint ODO_WORLD_SMOOTH = 1;
    public const uint ODO_OF_PIPELINE = 0;
    public const uint ODO_OF_BODY = 1;
    public const uint ODO_OF_CAMERA = 2;
    public const uint ODO_ALL_EVENTS = 4294967295;
    public const uint ODO_ANCHOR_POSE = 1;
    public const uint ODO_ANCHOR_VIEW = 2;
    public const uint ODO_ANCHOR_GEODETIC = 3;
    public const uint ODO_HEIGHT_ELLIPSOID = 1;
    public const uint ODO_HEIGHT_GEOID = 2;
    public const uint ODO_HEIGHT_TERRAIN = 3;
    public const uint ODO_ANCHOR_PLACED = 1;
    public const uint ODO_ANCHOR_VIEW_POSE = 2;
    public const uint ODO_ANCHOR_ON_EARTH = 4;
    public const uint ODO_ANCHOR_IN_FRONT = 8;
    public const uint ODO_REASON_NO_FIX = 10;
    public const uint ODO_REASON_NO_GROUND = 11;
    public const uint ODO_REASON_NO_ORIGIN = 12;
    public const string ODO_INTERFACE_ATTITUDE = "odo.attitude/1";
    public const uint ODO_LARGEST_PICTURE = 67108864;
    public const string ODO_INTERFACE_SCALE_SOURCE = "odo.scale_source/1";
    public const string ODO_INTERFACE_STEP_ESTIMATOR = "odo.step_estimator/1";
    public const string ODO_EXTENSION_TERRAIN = "odo.terrain/1";
    public const string ODO_INTERFACE_VO_FRONTEND = "odo.vo_frontend/1";

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_create(SessionOptions* options, odo_session** session, odo_error* error);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern void odo_session_destroy(odo_session* session);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_push(odo_session* session, odo_header* sample);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_push_imu(odo_session* session, long t_ns, double* gyro_b, double* accel_b);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_flush(odo_session* session);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_get_pose(odo_session* session, long t_ns, Pose* pose);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_get_pose_of(odo_session* session, uint of, uint world, long t_ns, Pose* pose);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_get_smooth_pose(odo_session* session, long t_ns, Pose* pose);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_set_callback(odo_session* session, uint* types, uint count, IntPtr callback, void* user);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_register_plugin(IntPtr entry, odo_error* error);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern ulong odo_current_plugin_call(byte* text, ulong capacity);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_get_statistics(odo_session* session, Statistics* statistics);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_last_error(odo_session* session, odo_error* error);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_to_geodetic(odo_session* session, double* p_n, double* geodetic);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_from_geodetic(odo_session* session, double* geodetic, double* p_n);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern long odo_session_save(odo_session* session, void* data, ulong capacity);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_session_load(odo_session* session, void* data, ulong size);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern byte* odo_version();
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern uint odo_abi_version();
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern byte* odo_status_text(int status);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern byte* odo_state_text(uint state);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern byte* odo_reason_text(uint reason);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern byte* odo_mode_text(uint mode);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_anchor_create(odo_session* session, AnchorPlace* place, ulong* id);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_anchor_get(odo_session* session, ulong id, uint world, long t_ns, Anchor* anchor);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern long odo_anchor_list(odo_session* session, ulong* ids, ulong capacity);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_anchor_remove(odo_session* session, ulong id);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recording_open(odo_string* path, odo_recording** recording, odo_error* error);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recording_next(odo_recording* recording, odo_header** message, void** picture, ulong* picture_size);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recording_loss(odo_recording* recording, odo_error* loss);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern void odo_recording_close(odo_recording* recording);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recorder_create(odo_string* path, odo_recorder** recorder, odo_error* error);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recorder_write(odo_recorder* recorder, odo_header* message, void* picture, ulong picture_size);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    public static extern int odo_recorder_close(odo_recorder* recorder);
  }

  public struct odo_asset {}
  public struct odo_instance {}
  public struct odo_session {}
  public struct odo_recording {}
  public struct odo_recorder {}

  [StructLayout(LayoutKind.Explicit, Size = 16)]
  public unsafe struct odo_string {
    [FieldOffset(0)] public byte* data;
    [FieldOffset(8)] public ulong size;
  }
  [StructLayout(LayoutKind.Explicit, Size = 32)]
  public unsafe struct odo_header {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public uint type;
    [FieldOffset(8)] public long t_ns;
    [FieldOffset(16)] public uint source;
    [FieldOffset(20)] public uint flags;
    [FieldOffset(24)] public float quality;
    [FieldOffset(28)] public uint reserved;
  }
  [StructLayout(LayoutKind.Explicit, Size = 40)]
  public unsafe struct odo_loan {
    [FieldOffset(0)] public void* owner;
    [FieldOffset(8)] public IntPtr retain;
    [FieldOffset(16)] public IntPtr release;
    [FieldOffset(24)] public IntPtr native;
    [FieldOffset(32)] public ulong reserved;
  }
  [StructLayout(LayoutKind.Explicit, Size = 72)]
  public unsafe struct odo_borrowed {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public odo_loan loan;
  }
  [StructLayout(LayoutKind.Explicit, Size = 160)]
  public unsafe struct Attitude {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Rotation q_n_b;
    [FieldOffset(64)] public fixed double covariance_n[9];
    [FieldOffset(136)] public Vector gyro_bias_b;
    public Attitude(long t_ns) { this = default(Attitude); header.struct_size = 160; header.type = 0x1001; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 96)]
  public unsafe struct Step {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public long t_start_ns;
    [FieldOffset(40)] public long t_end_ns;
    [FieldOffset(48)] public double length_m;
    [FieldOffset(56)] public double sigma_m;
    [FieldOffset(64)] public double frequency_hz;
    [FieldOffset(72)] public double heading_rad;
    [FieldOffset(80)] public uint mode;
    [FieldOffset(84)] public uint index;
    [FieldOffset(88)] public double heading_sigma_rad;
    public Step(long t_ns) { this = default(Step); header.struct_size = 96; header.type = 0x1002; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 40)]
  public unsafe struct MotionMode {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public uint mode;
    [FieldOffset(36)] public uint reserved;
    public MotionMode(long t_ns) { this = default(MotionMode); header.struct_size = 40; header.type = 0x1003; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 544)]
  public unsafe struct VoMotion {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public long t_from_ns;
    [FieldOffset(40)] public Rotation q_c0_c1;
    [FieldOffset(72)] public Vector p_c0_c1;
    [FieldOffset(96)] public fixed double covariance[36];
    [FieldOffset(384)] public Rotation q_n_c0;
    [FieldOffset(416)] public uint camera;
    [FieldOffset(420)] public uint state;
    [FieldOffset(424)] public uint reason;
    [FieldOffset(428)] public uint scale_group;
    [FieldOffset(432)] public uint tracked;
    [FieldOffset(436)] public uint inliers;
    [FieldOffset(440)] public double scale_sigma;
    [FieldOffset(448)] public Vector velocity_c1;
    [FieldOffset(472)] public Vector gravity_c1;
    [FieldOffset(496)] public Vector gyro_bias_b;
    [FieldOffset(520)] public Vector accel_bias_b;
    public VoMotion(long t_ns) { this = default(VoMotion); header.struct_size = 544; header.type = 0x1004; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 80)]
  public unsafe struct Scale {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public long valid_from_ns;
    [FieldOffset(40)] public long valid_to_ns;
    [FieldOffset(48)] public double scale;
    [FieldOffset(56)] public double sigma;
    [FieldOffset(64)] public double displacement_m;
    [FieldOffset(72)] public uint scale_group;
    [FieldOffset(76)] public uint reserved;
    public Scale(long t_ns) { this = default(Scale); header.struct_size = 80; header.type = 0x1005; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 440)]
  public unsafe struct Fix {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Vector p_n;
    [FieldOffset(56)] public fixed double covariance_n[9];
    [FieldOffset(128)] public Rotation q_n_b;
    [FieldOffset(160)] public fixed double orientation_cov_n[9];
    [FieldOffset(232)] public double yaw_rad;
    [FieldOffset(240)] public double yaw_sigma_rad;
    [FieldOffset(248)] public double latitude_rad;
    [FieldOffset(256)] public double longitude_rad;
    [FieldOffset(264)] public double height_m;
    [FieldOffset(272)] public double integrity;
    [FieldOffset(280)] public Vector landmark_n;
    [FieldOffset(304)] public double slant_distance_m;
    [FieldOffset(312)] public Vector lever_b;
    [FieldOffset(336)] public Vector yaw_axis_b;
    [FieldOffset(360)] public fixed double cross_covariance_n[9];
    [FieldOffset(432)] public double slant_sigma_m;
    public Fix(long t_ns) { this = default(Fix); header.struct_size = 440; header.type = 0x1006; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 384)]
  public unsafe struct RelativePose {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public long t_from_ns;
    [FieldOffset(40)] public Rotation q_b0_b1;
    [FieldOffset(72)] public Vector p_b0_b1;
    [FieldOffset(96)] public fixed double covariance[36];
    public RelativePose(long t_ns) { this = default(RelativePose); header.struct_size = 384; header.type = 0x100c; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 544)]
  public unsafe struct Pose {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Rotation q_n;
    [FieldOffset(64)] public Vector p_n;
    [FieldOffset(88)] public Vector velocity_n;
    [FieldOffset(112)] public fixed double covariance[36];
    [FieldOffset(400)] public double scale;
    [FieldOffset(408)] public double scale_sigma;
    [FieldOffset(416)] public double distance_m;
    [FieldOffset(424)] public uint state;
    [FieldOffset(428)] public uint reason;
    [FieldOffset(432)] public Vector angular_velocity;
    [FieldOffset(456)] public fixed double velocity_covariance[9];
    [FieldOffset(528)] public int floor;
    [FieldOffset(532)] public uint reserved;
    [FieldOffset(536)] public double floor_probability;
    public Pose(long t_ns) { this = default(Pose); header.struct_size = 544; header.type = 0x1007; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 40)]
  public unsafe struct State {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public uint state;
    [FieldOffset(36)] public uint reason;
    public State(long t_ns) { this = default(State); header.struct_size = 40; header.type = 0x1008; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 96)]
  public unsafe struct Correction {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Rotation q_n;
    [FieldOffset(64)] public Vector p_n;
    [FieldOffset(88)] public uint reason;
    [FieldOffset(92)] public uint reserved;
    public Correction(long t_ns) { this = default(Correction); header.struct_size = 96; header.type = 0x1009; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 224)]
  public unsafe struct Refined {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public uint camera;
    [FieldOffset(36)] public uint model;
    [FieldOffset(40)] public uint width;
    [FieldOffset(44)] public uint height;
    [FieldOffset(48)] public uint distortion_count;
    [FieldOffset(52)] public uint reserved;
    [FieldOffset(56)] public double fx;
    [FieldOffset(64)] public double fy;
    [FieldOffset(72)] public double cx;
    [FieldOffset(80)] public double cy;
    [FieldOffset(88)] public fixed double distortion[8];
    [FieldOffset(152)] public Rotation q_b_c;
    [FieldOffset(184)] public Vector p_b_c;
    [FieldOffset(208)] public long time_offset_ns;
    [FieldOffset(216)] public long line_time_ns;
    public Refined(long t_ns) { this = default(Refined); header.struct_size = 224; header.type = 0x100b; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 1200)]
  public unsafe struct Report {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public ulong count;
    [FieldOffset(40)] public uint severity;
    [FieldOffset(44)] public int status;
    [FieldOffset(48)] public fixed byte plugin[64];
    [FieldOffset(112)] public fixed byte key[64];
    [FieldOffset(176)] public fixed byte text[1024];
    public Report(long t_ns) { this = default(Report); header.struct_size = 1200; header.type = 0x100a; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 80)]
  public unsafe struct Imu {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Vector gyro_b;
    [FieldOffset(56)] public Vector accel_b;
    public Imu(long t_ns) { this = default(Imu); header.struct_size = 80; header.type = 0x1; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 64)]
  public unsafe struct Magnetometer {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Vector field_b;
    [FieldOffset(56)] public double sigma_t;
    public Magnetometer(long t_ns) { this = default(Magnetometer); header.struct_size = 64; header.type = 0x2; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 48)]
  public unsafe struct Barometer {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public double pressure_pa;
    [FieldOffset(40)] public double sigma_pa;
    public Barometer(long t_ns) { this = default(Barometer); header.struct_size = 48; header.type = 0x3; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 184)]
  public unsafe struct Gnss {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public double latitude_rad;
    [FieldOffset(40)] public double longitude_rad;
    [FieldOffset(48)] public double height_m;
    [FieldOffset(56)] public fixed double covariance_n[9];
    [FieldOffset(128)] public Vector velocity_n;
    [FieldOffset(152)] public uint satellites;
    [FieldOffset(156)] public uint reserved;
    [FieldOffset(160)] public Vector lever_b;
    public Gnss(long t_ns) { this = default(Gnss); header.struct_size = 184; header.type = 0x4; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 24)]
  public unsafe struct odo_plane {
    [FieldOffset(0)] public byte* data;
    [FieldOffset(8)] public long row_stride;
    [FieldOffset(16)] public uint pixel_stride;
    [FieldOffset(20)] public uint rows;
  }
  [StructLayout(LayoutKind.Explicit, Size = 256)]
  public unsafe struct Frame {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public odo_loan loan;
    [FieldOffset(72)] public uint format;
    [FieldOffset(76)] public uint width;
    [FieldOffset(80)] public uint height;
    [FieldOffset(84)] public uint plane_count;
    [FieldOffset(88)] public odo_plane planes0;
    [FieldOffset(112)] public odo_plane planes1;
    [FieldOffset(136)] public odo_plane planes2;
    [FieldOffset(160)] public odo_plane planes3;
    [FieldOffset(184)] public odo_plane mask;
    [FieldOffset(208)] public long exposure_ns;
    [FieldOffset(216)] public long line_time_ns;
    [FieldOffset(224)] public double fx;
    [FieldOffset(232)] public double fy;
    [FieldOffset(240)] public double cx;
    [FieldOffset(248)] public double cy;
    public Frame(long t_ns) { this = default(Frame); header.struct_size = 256; header.type = 0x801; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 216)]
  public unsafe struct Calibration {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public uint model;
    [FieldOffset(36)] public uint width;
    [FieldOffset(40)] public uint height;
    [FieldOffset(44)] public uint distortion_count;
    [FieldOffset(48)] public double fx;
    [FieldOffset(56)] public double fy;
    [FieldOffset(64)] public double cx;
    [FieldOffset(72)] public double cy;
    [FieldOffset(80)] public fixed double distortion[8];
    [FieldOffset(144)] public Rotation q_b_c;
    [FieldOffset(176)] public Vector p_b_c;
    [FieldOffset(200)] public long time_offset_ns;
    [FieldOffset(208)] public long line_time_ns;
    public Calibration(long t_ns) { this = default(Calibration); header.struct_size = 216; header.type = 0x5; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 64)]
  public unsafe struct ImuNoise {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public double gyro_noise;
    [FieldOffset(40)] public double gyro_walk;
    [FieldOffset(48)] public double accel_noise;
    [FieldOffset(56)] public double accel_walk;
    public ImuNoise(long t_ns) { this = default(ImuNoise); header.struct_size = 64; header.type = 0x6; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 88)]
  public unsafe struct Waypoint {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Vector p_n;
    [FieldOffset(56)] public double sigma_m;
    [FieldOffset(64)] public Vector lever_b;
    public Waypoint(long t_ns) { this = default(Waypoint); header.struct_size = 88; header.type = 0x7; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 56)]
  public unsafe struct EarthField {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public double declination_rad;
    [FieldOffset(40)] public double inclination_rad;
    [FieldOffset(48)] public double intensity_t;
    public EarthField(long t_ns) { this = default(EarthField); header.struct_size = 56; header.type = 0x8; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 384)]
  public unsafe struct PlatformPose {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public Rotation q_w;
    [FieldOffset(64)] public Vector p_w;
    [FieldOffset(88)] public fixed double covariance[36];
    [FieldOffset(376)] public uint state;
    [FieldOffset(380)] public uint world;
    public PlatformPose(long t_ns) { this = default(PlatformPose); header.struct_size = 384; header.type = 0x9; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 112)]
  public unsafe struct Range {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public ulong transmitter;
    [FieldOffset(40)] public double range_m;
    [FieldOffset(48)] public double sigma_m;
    [FieldOffset(56)] public Vector p_n;
    [FieldOffset(80)] public double transmitter_sigma_m;
    [FieldOffset(88)] public Vector lever_b;
    public Range(long t_ns) { this = default(Range); header.struct_size = 112; header.type = 0xa; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 48)]
  public unsafe struct SystemStep {
    [FieldOffset(0)] public odo_header header;
    [FieldOffset(32)] public ulong count;
    [FieldOffset(40)] public double distance_m;
    public SystemStep(long t_ns) { this = default(SystemStep); header.struct_size = 48; header.type = 0xb; header.t_ns = t_ns; }
  }
  [StructLayout(LayoutKind.Explicit, Size = 2048)]
  public unsafe struct odo_error {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public int status;
    [FieldOffset(8)] public fixed byte message[2040];
  }
  [StructLayout(LayoutKind.Explicit, Size = 104)]
  public unsafe struct SessionOptions {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public uint run;
    [FieldOffset(8)] public odo_string config_path;
    [FieldOffset(24)] public odo_string config_text;
    [FieldOffset(40)] public odo_string plugin_path;
    [FieldOffset(56)] public ulong seed;
    [FieldOffset(64)] public odo_string asset_path;
    [FieldOffset(80)] public uint flags;
    [FieldOffset(84)] public uint reserved;
    [FieldOffset(88)] public void* user;
    [FieldOffset(96)] public IntPtr get_service;
  }
  [StructLayout(LayoutKind.Explicit, Size = 184)]
  public unsafe struct Statistics {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public uint reserved;
    [FieldOffset(8)] public ulong pushed;
    [FieldOffset(16)] public ulong processed;
    [FieldOffset(24)] public ulong frames;
    [FieldOffset(32)] public ulong steps;
    [FieldOffset(40)] public ulong fixes_accepted;
    [FieldOffset(48)] public ulong fixes_rejected;
    [FieldOffset(56)] public ulong late;
    [FieldOffset(64)] public ulong duplicate;
    [FieldOffset(72)] public ulong invalid;
    [FieldOffset(80)] public ulong overflow;
    [FieldOffset(88)] public ulong gaps;
    [FieldOffset(96)] public ulong plugin_faults;
    [FieldOffset(104)] public double tracking_s;
    [FieldOffset(112)] public double degraded_s;
    [FieldOffset(120)] public double lost_s;
    [FieldOffset(128)] public double distance_m;
    [FieldOffset(136)] public ulong wild;
    [FieldOffset(144)] public ulong events_dropped;
    [FieldOffset(152)] public ulong unknown;
    [FieldOffset(160)] public double scale_sigma;
    [FieldOffset(168)] public double scale_by_inertia;
    [FieldOffset(176)] public double scale_by_steps;
  }
  [StructLayout(LayoutKind.Explicit, Size = 136)]
  public unsafe struct AnchorPlace {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public uint kind;
    [FieldOffset(8)] public long t_ns;
    [FieldOffset(16)] public uint world;
    [FieldOffset(20)] public uint height_above;
    [FieldOffset(24)] public Rotation q;
    [FieldOffset(56)] public Vector p;
    [FieldOffset(80)] public double latitude_rad;
    [FieldOffset(88)] public double longitude_rad;
    [FieldOffset(96)] public double height_m;
    [FieldOffset(104)] public double geoid_height_m;
    [FieldOffset(112)] public double sigma_m;
    [FieldOffset(120)] public odo_string name;
  }
  [StructLayout(LayoutKind.Explicit, Size = 264)]
  public unsafe struct Anchor {
    [FieldOffset(0)] public uint struct_size;
    [FieldOffset(4)] public uint kind;
    [FieldOffset(8)] public ulong id;
    [FieldOffset(16)] public long t_ns;
    [FieldOffset(24)] public uint flags;
    [FieldOffset(28)] public uint state;
    [FieldOffset(32)] public uint reason;
    [FieldOffset(36)] public uint reserved;
    [FieldOffset(40)] public Rotation q_n;
    [FieldOffset(72)] public Vector p_n;
    [FieldOffset(96)] public Rotation q_view;
    [FieldOffset(128)] public Vector p_view;
    [FieldOffset(152)] public double position_sigma_m;
    [FieldOffset(160)] public double yaw_sigma_rad;
    [FieldOffset(168)] public double view_sigma_m;
    [FieldOffset(176)] public double latitude_rad;
    [FieldOffset(184)] public double longitude_rad;
    [FieldOffset(192)] public double height_m;
    [FieldOffset(200)] public fixed byte name[64];
  }

  public sealed unsafe partial class Session {
    public int Push(ref Imu message) { fixed (Imu* p = &message) return Push(&p->header); }
    public int Push(ref Magnetometer message) { fixed (Magnetometer* p = &message) return Push(&p->header); }
    public int Push(ref Barometer message) { fixed (Barometer* p = &message) return Push(&p->header); }
    public int Push(ref Gnss message) { fixed (Gnss* p = &message) return Push(&p->header); }
    public int Push(ref Calibration message) { fixed (Calibration* p = &message) return Push(&p->header); }
    public int Push(ref ImuNoise message) { fixed (ImuNoise* p = &message) return Push(&p->header); }
    public int Push(ref Waypoint message) { fixed (Waypoint* p = &message) return Push(&p->header); }
    public int Push(ref EarthField message) { fixed (EarthField* p = &message) return Push(&p->header); }
    public int Push(ref PlatformPose message) { fixed (PlatformPose* p = &message) return Push(&p->header); }
    public int Push(ref Range message) { fixed (Range* p = &message) return Push(&p->header); }
    public int Push(ref SystemStep message) { fixed (SystemStep* p = &message) return Push(&p->header); }
  }

  public unsafe partial struct Event {
    public bool TryGet(out Imu message) { message = default(Imu); fixed (Imu* p = &message) return Copy(p, 0x1, 80); }
    public bool TryGet(out Magnetometer message) { message = default(Magnetometer); fixed (Magnetometer* p = &message) return Copy(p, 0x2, 64); }
    public bool TryGet(out Barometer message) { message = default(Barometer); fixed (Barometer* p = &message) return Copy(p, 0x3, 48); }
    public bool TryGet(out Gnss message) { message = default(Gnss); fixed (Gnss* p = &message) return Copy(p, 0x4, 184); }
    public bool TryGet(out Calibration message) { message = default(Calibration); fixed (Calibration* p = &message) return Copy(p, 0x5, 216); }
    public bool TryGet(out ImuNoise message) { message = default(ImuNoise); fixed (ImuNoise* p = &message) return Copy(p, 0x6, 64); }
    public bool TryGet(out Waypoint message) { message = default(Waypoint); fixed (Waypoint* p = &message) return Copy(p, 0x7, 88); }
    public bool TryGet(out EarthField message) { message = default(EarthField); fixed (EarthField* p = &message) return Copy(p, 0x8, 56); }
    public bool TryGet(out PlatformPose message) { message = default(PlatformPose); fixed (PlatformPose* p = &message) return Copy(p, 0x9, 384); }
    public bool TryGet(out Range message) { message = default(Range); fixed (Range* p = &message) return Copy(p, 0xa, 112); }
    public bool TryGet(out SystemStep message) { message = default(SystemStep); fixed (SystemStep* p = &message) return Copy(p, 0xb, 48); }
    public bool TryGet(out Frame message) { message = default(Frame); fixed (Frame* p = &message) return Copy(p, 0x801, 256); }
    public bool TryGet(out Attitude message) { message = default(Attitude); fixed (Attitude* p = &message) return Copy(p, 0x1001, 160); }
    public bool TryGet(out Step message) { message = default(Step); fixed (Step* p = &message) return Copy(p, 0x1002, 96); }
    public bool TryGet(out MotionMode message) { message = default(MotionMode); fixed (MotionMode* p = &message) return Copy(p, 0x1003, 40); }
    public bool TryGet(out VoMotion message) { message = default(VoMotion); fixed (VoMotion* p = &message) return Copy(p, 0x1004, 544); }
    public bool TryGet(out Scale message) { message = default(Scale); fixed (Scale* p = &message) return Copy(p, 0x1005, 80); }
    public bool TryGet(out Fix message) { message = default(Fix); fixed (Fix* p = &message) return Copy(p, 0x1006, 440); }
    public bool TryGet(out Pose message) { message = default(Pose); fixed (Pose* p = &message) return Copy(p, 0x1007, 544); }
    public bool TryGet(out State message) { message = default(State); fixed (State* p = &message) return Copy(p, 0x1008, 40); }
    public bool TryGet(out Correction message) { message = default(Correction); fixed (Correction* p = &message) return Copy(p, 0x1009, 96); }
    public bool TryGet(out Report message) { message = default(Report); fixed (Report* p = &message) return Copy(p, 0x100a, 1200); }
    public bool TryGet(out Refined message) { message = default(Refined); fixed (Refined* p = &message) return Copy(p, 0x100b, 224); }
    public bool TryGet(out RelativePose message) { message = default(RelativePose); fixed (RelativePose* p = &message) return Copy(p, 0x100c, 384); }
  }
}
