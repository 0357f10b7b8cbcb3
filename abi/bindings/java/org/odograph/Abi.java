// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
package org.odograph;

/** Constants and messages with their C names, documented in the C headers. Unsigned numbers are represented as signed ones. */
public final class Abi {
    private Abi() {}
    static { System.loadLibrary("odograph_jni"); }

    public static final int ODO_ABI_MAJOR = 1;
    public static final int ODO_ABI_MINOR = 0;
    public static final int ODO_OK = 0;
    public static final int ODO_NOT_READY = 1;
    public static final int ODO_END = 2;
    public static final int ODO_PARTIAL = 3;
    public static final int ODO_E_ARGUMENT = -1;
    public static final int ODO_E_DISCARD = -2;
    public static final int ODO_E_EXHAUSTED = -3;
    public static final int ODO_E_UNSUPPORTED = -4;
    public static final int ODO_E_STRUCT_SIZE = -5;
    public static final int ODO_E_VERSION = -6;
    public static final int ODO_E_STATE = -7;
    public static final int ODO_E_CONFIG = -8;
    public static final int ODO_E_NOT_FOUND = -9;
    public static final int ODO_E_DATA = -10;
    public static final int ODO_E_IO = -11;
    public static final int ODO_E_MEMORY = -1001;
    public static final int ODO_E_ERROR = -1002;
    public static final int ODO_E_FATAL = -2001;
    public static final int ODO_BORROWED = 2048;
    public static final int ODO_TYPE_IMU = 1;
    public static final int ODO_TYPE_MAGNETOMETER = 2;
    public static final int ODO_TYPE_BAROMETER = 3;
    public static final int ODO_TYPE_GNSS = 4;
    public static final int ODO_TYPE_CALIBRATION = 5;
    public static final int ODO_TYPE_IMU_NOISE = 6;
    public static final int ODO_TYPE_WAYPOINT = 7;
    public static final int ODO_TYPE_EARTH_FIELD = 8;
    public static final int ODO_TYPE_PLATFORM_POSE = 9;
    public static final int ODO_TYPE_RANGE = 10;
    public static final int ODO_TYPE_SYSTEM_STEP = 11;
    public static final int ODO_TYPE_FRAME = 2049;
    public static final int ODO_TYPE_ATTITUDE = 4097;
    public static final int ODO_TYPE_STEP = 4098;
    public static final int ODO_TYPE_MOTION_MODE = 4099;
    public static final int ODO_TYPE_VO_MOTION = 4100;
    public static final int ODO_TYPE_SCALE = 4101;
    public static final int ODO_TYPE_FIX = 4102;
    public static final int ODO_TYPE_POSE = 4103;
    public static final int ODO_TYPE_STATE = 4104;
    public static final int ODO_TYPE_CORRECTION = 4105;
    public static final int ODO_TYPE_REPORT = 4106;
    public static final int ODO_TYPE_REFINED = 4107;
    public static final int ODO_TYPE_RELATIVE_POSE = 4108;
    public static final int ODO_VENDOR_EVENT = 1024;
    public static final int ODO_LARGEST_MESSAGE = 65536;
    public static final int ODO_FLAG_QUALITY = -2147483648;
    public static final int ODO_FLAG_DESCRIPTION = 268435456;
    public static final int ODO_FLAG_HOST_MASK = 251658240;
    public static final int ODO_FLAG_ACCEPTED = 16777216;
    public static final int ODO_FLAG_NAVIGATION = 33554432;
    public static final String ODO_NATIVE_HARDWARE_BUFFER = "android.hardware_buffer/1";
    public static final String ODO_NATIVE_PIXEL_BUFFER = "apple.pixel_buffer/1";
    public static final int ODO_ATTITUDE_MAGNETIC_NORTH = 1;
    public static final int ODO_ATTITUDE_MAG_DISTURBED = 2;
    public static final int ODO_ATTITUDE_REST = 4;
    public static final int ODO_ATTITUDE_TRUE_NORTH = 8;
    public static final int ODO_ATTITUDE_COVARIANCE = 16;
    public static final int ODO_ATTITUDE_GYRO_BIAS = 32;
    public static final int ODO_MODE_UNKNOWN = 0;
    public static final int ODO_MODE_STATIC = 1;
    public static final int ODO_MODE_WALKING_TEXTING = 2;
    public static final int ODO_MODE_WALKING_SWINGING = 3;
    public static final int ODO_MODE_WALKING_POCKET = 4;
    public static final int ODO_MODE_STAIRS = 5;
    public static final int ODO_MODE_RUNNING = 6;
    public static final int ODO_MODE_HANDLING = 7;
    public static final int ODO_STEP_HEADING = 1;
    public static final int ODO_STEP_HEADING_SIGMA = 2;
    public static final int ODO_TRACKING = 1;
    public static final int ODO_DEGRADED = 2;
    public static final int ODO_LOST = 3;
    public static final int ODO_REASON_NONE = 0;
    public static final int ODO_REASON_INITIALISING = 1;
    public static final int ODO_REASON_TOO_DARK = 2;
    public static final int ODO_REASON_TOO_FAST = 3;
    public static final int ODO_REASON_FEW_FEATURES = 4;
    public static final int ODO_REASON_NO_PARALLAX = 5;
    public static final int ODO_REASON_NO_STEPS = 6;
    public static final int ODO_REASON_SENSOR_SILENT = 7;
    public static final int ODO_REASON_PLUGIN_FAILED = 8;
    public static final int ODO_REASON_NO_SCALE = 9;
    public static final int ODO_VO_ROTATION = 1;
    public static final int ODO_VO_TRANSLATION = 2;
    public static final int ODO_VO_COVARIANCE = 4;
    public static final int ODO_VO_METRIC = 8;
    public static final int ODO_VO_INERTIAL = 16;
    public static final int ODO_SCALE_HORIZONTAL = 1;
    public static final int ODO_SCALE_STEADY = 2;
    public static final int ODO_SCALE_NOT_BY_STEPS = 4;
    public static final int ODO_FIX_NORTH = 1;
    public static final int ODO_FIX_EAST = 2;
    public static final int ODO_FIX_DOWN = 4;
    public static final int ODO_FIX_YAW = 8;
    public static final int ODO_FIX_ORIENTATION = 16;
    public static final int ODO_FIX_GEODETIC = 32;
    public static final int ODO_FIX_SLANT = 64;
    public static final int ODO_FIX_COVARIANCE = 128;
    public static final int ODO_FIX_ORIENTATION_COVARIANCE = 256;
    public static final int ODO_FIX_INTEGRITY = 512;
    public static final int ODO_FIX_LEVER = 1024;
    public static final int ODO_FIX_CROSS_COVARIANCE = 2048;
    public static final int ODO_FIX_SLANT_SIGMA = 4096;
    public static final int ODO_RELATIVE_POSE_TRANSLATION = 1;
    public static final int ODO_RELATIVE_POSE_ROTATION = 2;
    public static final int ODO_POSE_ORIENTATION = 1;
    public static final int ODO_POSE_POSITION = 2;
    public static final int ODO_POSE_VELOCITY = 4;
    public static final int ODO_POSE_METRIC = 8;
    public static final int ODO_POSE_CAMERA = 16;
    public static final int ODO_POSE_EXTRAPOLATED = 32;
    public static final int ODO_POSE_ANGULAR_VELOCITY = 64;
    public static final int ODO_POSE_VELOCITY_COVARIANCE = 128;
    public static final int ODO_POSE_COVARIANCE = 256;
    public static final int ODO_POSE_NORTH = 512;
    public static final int ODO_POSE_FLOOR = 1024;
    public static final int ODO_POSE_CARRIED = 2048;
    public static final int ODO_CORRECTION_FIX = 1;
    public static final int ODO_CORRECTION_SCALE = 2;
    public static final int ODO_CORRECTION_RECOVERED = 3;
    public static final int ODO_CORRECTION_RESTART = 4;
    public static final int ODO_REFINED_EXTRINSICS = 1;
    public static final int ODO_REFINED_TIME_OFFSET = 2;
    public static final int ODO_REFINED_LINE_TIME = 4;
    public static final int ODO_SEVERITY_DEBUG = 0;
    public static final int ODO_SEVERITY_INFO = 1;
    public static final int ODO_SEVERITY_WARNING = 2;
    public static final int ODO_SEVERITY_ERROR = 3;
    public static final int ODO_IMU_GYRO = 1;
    public static final int ODO_IMU_ACCEL = 2;
    public static final int ODO_IMU_GYRO_CORRECTED = 4;
    public static final int ODO_IMU_ACCEL_CORRECTED = 8;
    public static final int ODO_MAGNETOMETER_SIGMA = 1;
    public static final int ODO_MAGNETOMETER_CORRECTED = 2;
    public static final int ODO_BAROMETER_SIGMA = 1;
    public static final int ODO_GNSS_POSITION = 1;
    public static final int ODO_GNSS_HEIGHT = 2;
    public static final int ODO_GNSS_COVARIANCE = 4;
    public static final int ODO_GNSS_VELOCITY = 8;
    public static final int ODO_GNSS_LEVER = 16;
    public static final int ODO_FORMAT_GREY8 = 1;
    public static final int ODO_FORMAT_NV12 = 2;
    public static final int ODO_FORMAT_NV21 = 3;
    public static final int ODO_FORMAT_RGB8 = 4;
    public static final int ODO_FORMAT_RGBA8 = 5;
    public static final int ODO_FORMAT_YUV420 = 6;
    public static final int ODO_FORMAT_BGRA8 = 7;
    public static final int ODO_FRAME_EXPOSURE = 1;
    public static final int ODO_FRAME_LINE_TIME = 2;
    public static final int ODO_FRAME_MASK = 4;
    public static final int ODO_FRAME_INTRINSICS = 8;
    public static final int ODO_CAMERA_PINHOLE = 1;
    public static final int ODO_CAMERA_KANNALA_BRANDT = 2;
    public static final int ODO_CALIBRATION_EXTRINSICS = 1;
    public static final int ODO_CALIBRATION_TIME_OFFSET = 2;
    public static final int ODO_CALIBRATION_LINE_TIME = 4;
    public static final int ODO_WAYPOINT_VERTICAL = 1;
    public static final int ODO_WAYPOINT_LEVER = 2;
    public static final int ODO_EARTH_FIELD_DECLINATION = 1;
    public static final int ODO_EARTH_FIELD_INCLINATION = 2;
    public static final int ODO_EARTH_FIELD_INTENSITY = 4;
    public static final int ODO_PLATFORM_POSE_CAMERA = 1;
    public static final int ODO_PLATFORM_POSE_COVARIANCE = 2;
    public static final int ODO_RANGE_TRANSMITTER = 1;
    public static final int ODO_RANGE_LEVER = 2;
    public static final int ODO_SYSTEM_STEP_COUNT = 1;
    public static final int ODO_SYSTEM_STEP_DISTANCE = 2;
    public static final String ODO_SERVICE_REPORT = "odo.report/1";
    public static final String ODO_SERVICE_RANDOM = "odo.random/1";
    public static final String ODO_SERVICE_ASSETS = "odo.assets/1";
    public static final String ODO_SERVICE_CONTENTS = "odo.contents/1";
    public static final String ODO_SERVICE_WAKE = "odo.wake/1";
    public static final int ODO_PARAMETER_BOOL = 1;
    public static final int ODO_PARAMETER_INT = 2;
    public static final int ODO_PARAMETER_REAL = 3;
    public static final int ODO_PARAMETER_STRING = 4;
    public static final int ODO_PARAMETER_CHOICE = 5;
    public static final int ODO_PARAMETER_REALS = 6;
    public static final int ODO_LARGEST_STATE = 16777216;
    public static final int ODO_PLUGIN_SEVERAL_CAMERAS = 1;
    public static final int ODO_PLUGIN_NATIVE_FRAMES = 2;
    public static final String ODO_PLUGIN_ENTRY_SYMBOL = "odo_plugin_entry_v1";
    public static final String ODO_INTERFACE_ABSOLUTE_FIXER = "odo.absolute_fixer/1";
    public static final int ODO_RUN_LIVE = 0;
    public static final int ODO_RUN_REPLAY = 1;
    public static final int ODO_SESSION_CRASH_NOTES = 1;
    public static final long ODO_TIME_LATEST = -9223372036854775808L;
    public static final int ODO_WORLD_CORRECTED = 0;
    public static final int ODO_WORLD_SMOOTH = 1;
    public static final int ODO_OF_PIPELINE = 0;
    public static final int ODO_OF_BODY = 1;
    public static final int ODO_OF_CAMERA = 2;
    public static final int ODO_ALL_EVENTS = -1;
    public static final int ODO_ANCHOR_POSE = 1;
    public static final int ODO_ANCHOR_VIEW = 2;
    public static final int ODO_ANCHOR_GEODETIC = 3;
    public static final int ODO_HEIGHT_ELLIPSOID = 1;
    public static final int ODO_HEIGHT_GEOID = 2;
    public static final int ODO_HEIGHT_TERRAIN = 3;
    public static final int ODO_ANCHOR_PLACED = 1;
    public static final int ODO_ANCHOR_VIEW_POSE = 2;
    public static final int ODO_ANCHOR_ON_EARTH = 4;
    public static final int ODO_ANCHOR_IN_FRONT = 8;
    public static final int ODO_REASON_NO_FIX = 10;
    public static final int ODO_REASON_NO_GROUND = 11;
    public static final int ODO_REASON_NO_ORIGIN = 12;
    public static final String ODO_INTERFACE_ATTITUDE = "odo.attitude/1";
    public static final int ODO_LARGEST_PICTURE = 67108864;
    public static final String ODO_INTERFACE_SCALE_SOURCE = "odo.scale_source/1";
    public static final String ODO_INTERFACE_STEP_ESTIMATOR = "odo.step_estimator/1";
    public static final String ODO_EXTENSION_TERRAIN = "odo.terrain/1";
    public static final String ODO_INTERFACE_VO_FRONTEND = "odo.vo_frontend/1";

    static native int odo_session_create(long options, long session, long error);
    static native void odo_session_destroy(long session);
    static native int odo_session_push(long session, long sample);
    static native int odo_session_push_imu(long session, long t_ns, long gyro_b, long accel_b);
    static native int odo_session_flush(long session);
    static native int odo_session_get_pose(long session, long t_ns, long pose);
    static native int odo_session_get_pose_of(long session, int of, int world, long t_ns, long pose);
    static native int odo_session_get_smooth_pose(long session, long t_ns, long pose);
    static native int odo_session_set_callback(long session, long types, int count, long callback, long user);
    static native int odo_register_plugin(long entry, long error);
    static native long odo_current_plugin_call(long text, long capacity);
    static native int odo_session_get_statistics(long session, long statistics);
    static native int odo_session_last_error(long session, long error);
    static native int odo_session_to_geodetic(long session, long p_n, long geodetic);
    static native int odo_session_from_geodetic(long session, long geodetic, long p_n);
    static native long odo_session_save(long session, long data, long capacity);
    static native int odo_session_load(long session, long data, long size);
    static native String odo_version();
    static native int odo_abi_version();
    static native String odo_status_text(int status);
    static native String odo_state_text(int state);
    static native String odo_reason_text(int reason);
    static native String odo_mode_text(int mode);
    static native int odo_anchor_create(long session, long place, long id);
    static native int odo_anchor_get(long session, long id, int world, long t_ns, long anchor);
    static native long odo_anchor_list(long session, long ids, long capacity);
    static native int odo_anchor_remove(long session, long id);
    static native int odo_recording_open(long path, long recording, long error);
    static native int odo_recording_next(long recording, long message, long picture, long picture_size);
    static native int odo_recording_loss(long recording, long loss);
    static native void odo_recording_close(long recording);
    static native int odo_recorder_create(long path, long recorder, long error);
    static native int odo_recorder_write(long recorder, long message, long picture, long picture_size);
    static native int odo_recorder_close(long recorder);

    public static final class Imu extends Struct {
        public static final int SIZE = 80;
        public static final int TYPE = 0x1;
        public Imu(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Imu(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Imu type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Imu t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Imu source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Imu flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Imu quality(float value) { memory.putFloat(24, value); return this; }
        public double gyro_b(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] gyro_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = gyro_b(i); return values; }
        public Imu gyro_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double accel_b(int i) { return memory.getDouble(56 + 8 * i); }
        public double[] accel_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = accel_b(i); return values; }
        public Imu accel_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(56 + 8 * i, values[i]); return this; }
    }
    public static final class Magnetometer extends Struct {
        public static final int SIZE = 64;
        public static final int TYPE = 0x2;
        public Magnetometer(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Magnetometer(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Magnetometer type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Magnetometer t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Magnetometer source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Magnetometer flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Magnetometer quality(float value) { memory.putFloat(24, value); return this; }
        public double field_b(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] field_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = field_b(i); return values; }
        public Magnetometer field_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double sigma_t() { return memory.getDouble(56); }
        public Magnetometer sigma_t(double value) { memory.putDouble(56, value); return this; }
    }
    public static final class Barometer extends Struct {
        public static final int SIZE = 48;
        public static final int TYPE = 0x3;
        public Barometer(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Barometer(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Barometer type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Barometer t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Barometer source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Barometer flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Barometer quality(float value) { memory.putFloat(24, value); return this; }
        public double pressure_pa() { return memory.getDouble(32); }
        public Barometer pressure_pa(double value) { memory.putDouble(32, value); return this; }
        public double sigma_pa() { return memory.getDouble(40); }
        public Barometer sigma_pa(double value) { memory.putDouble(40, value); return this; }
    }
    public static final class Gnss extends Struct {
        public static final int SIZE = 184;
        public static final int TYPE = 0x4;
        public Gnss(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Gnss(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Gnss type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Gnss t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Gnss source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Gnss flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Gnss quality(float value) { memory.putFloat(24, value); return this; }
        public double latitude_rad() { return memory.getDouble(32); }
        public Gnss latitude_rad(double value) { memory.putDouble(32, value); return this; }
        public double longitude_rad() { return memory.getDouble(40); }
        public Gnss longitude_rad(double value) { memory.putDouble(40, value); return this; }
        public double height_m() { return memory.getDouble(48); }
        public Gnss height_m(double value) { memory.putDouble(48, value); return this; }
        public double covariance_n(int i) { return memory.getDouble(56 + 8 * i); }
        public double[] covariance_n() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = covariance_n(i); return values; }
        public Gnss covariance_n(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(56 + 8 * i, values[i]); return this; }
        public double velocity_n(int i) { return memory.getDouble(128 + 8 * i); }
        public double[] velocity_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = velocity_n(i); return values; }
        public Gnss velocity_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(128 + 8 * i, values[i]); return this; }
        public int satellites() { return memory.getInt(152); }
        public Gnss satellites(int value) { memory.putInt(152, value); return this; }
        public double lever_b(int i) { return memory.getDouble(160 + 8 * i); }
        public double[] lever_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = lever_b(i); return values; }
        public Gnss lever_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(160 + 8 * i, values[i]); return this; }
    }
    public static final class Calibration extends Struct {
        public static final int SIZE = 216;
        public static final int TYPE = 0x5;
        public Calibration(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Calibration(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Calibration type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Calibration t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Calibration source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Calibration flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Calibration quality(float value) { memory.putFloat(24, value); return this; }
        public int model() { return memory.getInt(32); }
        public Calibration model(int value) { memory.putInt(32, value); return this; }
        public int width() { return memory.getInt(36); }
        public Calibration width(int value) { memory.putInt(36, value); return this; }
        public int height() { return memory.getInt(40); }
        public Calibration height(int value) { memory.putInt(40, value); return this; }
        public int distortion_count() { return memory.getInt(44); }
        public Calibration distortion_count(int value) { memory.putInt(44, value); return this; }
        public double fx() { return memory.getDouble(48); }
        public Calibration fx(double value) { memory.putDouble(48, value); return this; }
        public double fy() { return memory.getDouble(56); }
        public Calibration fy(double value) { memory.putDouble(56, value); return this; }
        public double cx() { return memory.getDouble(64); }
        public Calibration cx(double value) { memory.putDouble(64, value); return this; }
        public double cy() { return memory.getDouble(72); }
        public Calibration cy(double value) { memory.putDouble(72, value); return this; }
        public double distortion(int i) { return memory.getDouble(80 + 8 * i); }
        public double[] distortion() { double[] values = new double[8]; for (int i = 0; i < 8; ++i) values[i] = distortion(i); return values; }
        public Calibration distortion(double... values) { for (int i = 0; i < 8; ++i) memory.putDouble(80 + 8 * i, values[i]); return this; }
        public double q_b_c(int i) { return memory.getDouble(144 + 8 * i); }
        public double[] q_b_c() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_b_c(i); return values; }
        public Calibration q_b_c(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(144 + 8 * i, values[i]); return this; }
        public double p_b_c(int i) { return memory.getDouble(176 + 8 * i); }
        public double[] p_b_c() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_b_c(i); return values; }
        public Calibration p_b_c(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(176 + 8 * i, values[i]); return this; }
        public long time_offset_ns() { return memory.getLong(200); }
        public Calibration time_offset_ns(long value) { memory.putLong(200, value); return this; }
        public long line_time_ns() { return memory.getLong(208); }
        public Calibration line_time_ns(long value) { memory.putLong(208, value); return this; }
    }
    public static final class ImuNoise extends Struct {
        public static final int SIZE = 64;
        public static final int TYPE = 0x6;
        public ImuNoise(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public ImuNoise(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public ImuNoise type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public ImuNoise t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public ImuNoise source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public ImuNoise flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public ImuNoise quality(float value) { memory.putFloat(24, value); return this; }
        public double gyro_noise() { return memory.getDouble(32); }
        public ImuNoise gyro_noise(double value) { memory.putDouble(32, value); return this; }
        public double gyro_walk() { return memory.getDouble(40); }
        public ImuNoise gyro_walk(double value) { memory.putDouble(40, value); return this; }
        public double accel_noise() { return memory.getDouble(48); }
        public ImuNoise accel_noise(double value) { memory.putDouble(48, value); return this; }
        public double accel_walk() { return memory.getDouble(56); }
        public ImuNoise accel_walk(double value) { memory.putDouble(56, value); return this; }
    }
    public static final class Waypoint extends Struct {
        public static final int SIZE = 88;
        public static final int TYPE = 0x7;
        public Waypoint(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Waypoint(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Waypoint type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Waypoint t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Waypoint source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Waypoint flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Waypoint quality(float value) { memory.putFloat(24, value); return this; }
        public double p_n(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Waypoint p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double sigma_m() { return memory.getDouble(56); }
        public Waypoint sigma_m(double value) { memory.putDouble(56, value); return this; }
        public double lever_b(int i) { return memory.getDouble(64 + 8 * i); }
        public double[] lever_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = lever_b(i); return values; }
        public Waypoint lever_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(64 + 8 * i, values[i]); return this; }
    }
    public static final class EarthField extends Struct {
        public static final int SIZE = 56;
        public static final int TYPE = 0x8;
        public EarthField(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public EarthField(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public EarthField type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public EarthField t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public EarthField source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public EarthField flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public EarthField quality(float value) { memory.putFloat(24, value); return this; }
        public double declination_rad() { return memory.getDouble(32); }
        public EarthField declination_rad(double value) { memory.putDouble(32, value); return this; }
        public double inclination_rad() { return memory.getDouble(40); }
        public EarthField inclination_rad(double value) { memory.putDouble(40, value); return this; }
        public double intensity_t() { return memory.getDouble(48); }
        public EarthField intensity_t(double value) { memory.putDouble(48, value); return this; }
    }
    public static final class PlatformPose extends Struct {
        public static final int SIZE = 384;
        public static final int TYPE = 0x9;
        public PlatformPose(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public PlatformPose(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public PlatformPose type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public PlatformPose t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public PlatformPose source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public PlatformPose flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public PlatformPose quality(float value) { memory.putFloat(24, value); return this; }
        public double q_w(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] q_w() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_w(i); return values; }
        public PlatformPose q_w(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double p_w(int i) { return memory.getDouble(64 + 8 * i); }
        public double[] p_w() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_w(i); return values; }
        public PlatformPose p_w(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(64 + 8 * i, values[i]); return this; }
        public double covariance(int i) { return memory.getDouble(88 + 8 * i); }
        public double[] covariance() { double[] values = new double[36]; for (int i = 0; i < 36; ++i) values[i] = covariance(i); return values; }
        public PlatformPose covariance(double... values) { for (int i = 0; i < 36; ++i) memory.putDouble(88 + 8 * i, values[i]); return this; }
        public int state() { return memory.getInt(376); }
        public PlatformPose state(int value) { memory.putInt(376, value); return this; }
        public int world() { return memory.getInt(380); }
        public PlatformPose world(int value) { memory.putInt(380, value); return this; }
    }
    public static final class Range extends Struct {
        public static final int SIZE = 112;
        public static final int TYPE = 0xa;
        public Range(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Range(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Range type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Range t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Range source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Range flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Range quality(float value) { memory.putFloat(24, value); return this; }
        public long transmitter() { return memory.getLong(32); }
        public Range transmitter(long value) { memory.putLong(32, value); return this; }
        public double range_m() { return memory.getDouble(40); }
        public Range range_m(double value) { memory.putDouble(40, value); return this; }
        public double sigma_m() { return memory.getDouble(48); }
        public Range sigma_m(double value) { memory.putDouble(48, value); return this; }
        public double p_n(int i) { return memory.getDouble(56 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Range p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(56 + 8 * i, values[i]); return this; }
        public double transmitter_sigma_m() { return memory.getDouble(80); }
        public Range transmitter_sigma_m(double value) { memory.putDouble(80, value); return this; }
        public double lever_b(int i) { return memory.getDouble(88 + 8 * i); }
        public double[] lever_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = lever_b(i); return values; }
        public Range lever_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(88 + 8 * i, values[i]); return this; }
    }
    public static final class SystemStep extends Struct {
        public static final int SIZE = 48;
        public static final int TYPE = 0xb;
        public SystemStep(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public SystemStep(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public SystemStep type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public SystemStep t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public SystemStep source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public SystemStep flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public SystemStep quality(float value) { memory.putFloat(24, value); return this; }
        public long count() { return memory.getLong(32); }
        public SystemStep count(long value) { memory.putLong(32, value); return this; }
        public double distance_m() { return memory.getDouble(40); }
        public SystemStep distance_m(double value) { memory.putDouble(40, value); return this; }
    }
    public static final class Frame extends Struct {
        public static final int SIZE = 256;
        public static final int TYPE = 0x801;
        public Frame(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Frame(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Frame type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Frame t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Frame source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Frame flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Frame quality(float value) { memory.putFloat(24, value); return this; }
        public long loan_owner() { return memory.getLong(32); }
        public Frame loan_owner(long value) { memory.putLong(32, value); return this; }
        public long loan_retain() { return memory.getLong(40); }
        public Frame loan_retain(long value) { memory.putLong(40, value); return this; }
        public long loan_release() { return memory.getLong(48); }
        public Frame loan_release(long value) { memory.putLong(48, value); return this; }
        public long loan_native() { return memory.getLong(56); }
        public Frame loan_native(long value) { memory.putLong(56, value); return this; }
        public long loan_reserved() { return memory.getLong(64); }
        public Frame loan_reserved(long value) { memory.putLong(64, value); return this; }
        public int format() { return memory.getInt(72); }
        public Frame format(int value) { memory.putInt(72, value); return this; }
        public int width() { return memory.getInt(76); }
        public Frame width(int value) { memory.putInt(76, value); return this; }
        public int height() { return memory.getInt(80); }
        public Frame height(int value) { memory.putInt(80, value); return this; }
        public int plane_count() { return memory.getInt(84); }
        public Frame plane_count(int value) { memory.putInt(84, value); return this; }
        public long planes0_data() { return memory.getLong(88); }
        public Frame planes0_data(long value) { memory.putLong(88, value); return this; }
        public long planes0_row_stride() { return memory.getLong(96); }
        public Frame planes0_row_stride(long value) { memory.putLong(96, value); return this; }
        public int planes0_pixel_stride() { return memory.getInt(104); }
        public Frame planes0_pixel_stride(int value) { memory.putInt(104, value); return this; }
        public int planes0_rows() { return memory.getInt(108); }
        public Frame planes0_rows(int value) { memory.putInt(108, value); return this; }
        public long planes1_data() { return memory.getLong(112); }
        public Frame planes1_data(long value) { memory.putLong(112, value); return this; }
        public long planes1_row_stride() { return memory.getLong(120); }
        public Frame planes1_row_stride(long value) { memory.putLong(120, value); return this; }
        public int planes1_pixel_stride() { return memory.getInt(128); }
        public Frame planes1_pixel_stride(int value) { memory.putInt(128, value); return this; }
        public int planes1_rows() { return memory.getInt(132); }
        public Frame planes1_rows(int value) { memory.putInt(132, value); return this; }
        public long planes2_data() { return memory.getLong(136); }
        public Frame planes2_data(long value) { memory.putLong(136, value); return this; }
        public long planes2_row_stride() { return memory.getLong(144); }
        public Frame planes2_row_stride(long value) { memory.putLong(144, value); return this; }
        public int planes2_pixel_stride() { return memory.getInt(152); }
        public Frame planes2_pixel_stride(int value) { memory.putInt(152, value); return this; }
        public int planes2_rows() { return memory.getInt(156); }
        public Frame planes2_rows(int value) { memory.putInt(156, value); return this; }
        public long planes3_data() { return memory.getLong(160); }
        public Frame planes3_data(long value) { memory.putLong(160, value); return this; }
        public long planes3_row_stride() { return memory.getLong(168); }
        public Frame planes3_row_stride(long value) { memory.putLong(168, value); return this; }
        public int planes3_pixel_stride() { return memory.getInt(176); }
        public Frame planes3_pixel_stride(int value) { memory.putInt(176, value); return this; }
        public int planes3_rows() { return memory.getInt(180); }
        public Frame planes3_rows(int value) { memory.putInt(180, value); return this; }
        public long mask_data() { return memory.getLong(184); }
        public Frame mask_data(long value) { memory.putLong(184, value); return this; }
        public long mask_row_stride() { return memory.getLong(192); }
        public Frame mask_row_stride(long value) { memory.putLong(192, value); return this; }
        public int mask_pixel_stride() { return memory.getInt(200); }
        public Frame mask_pixel_stride(int value) { memory.putInt(200, value); return this; }
        public int mask_rows() { return memory.getInt(204); }
        public Frame mask_rows(int value) { memory.putInt(204, value); return this; }
        public long exposure_ns() { return memory.getLong(208); }
        public Frame exposure_ns(long value) { memory.putLong(208, value); return this; }
        public long line_time_ns() { return memory.getLong(216); }
        public Frame line_time_ns(long value) { memory.putLong(216, value); return this; }
        public double fx() { return memory.getDouble(224); }
        public Frame fx(double value) { memory.putDouble(224, value); return this; }
        public double fy() { return memory.getDouble(232); }
        public Frame fy(double value) { memory.putDouble(232, value); return this; }
        public double cx() { return memory.getDouble(240); }
        public Frame cx(double value) { memory.putDouble(240, value); return this; }
        public double cy() { return memory.getDouble(248); }
        public Frame cy(double value) { memory.putDouble(248, value); return this; }
    }
    public static final class Attitude extends Struct {
        public static final int SIZE = 160;
        public static final int TYPE = 0x1001;
        public Attitude(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Attitude(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Attitude type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Attitude t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Attitude source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Attitude flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Attitude quality(float value) { memory.putFloat(24, value); return this; }
        public double q_n_b(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] q_n_b() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n_b(i); return values; }
        public Attitude q_n_b(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double covariance_n(int i) { return memory.getDouble(64 + 8 * i); }
        public double[] covariance_n() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = covariance_n(i); return values; }
        public Attitude covariance_n(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(64 + 8 * i, values[i]); return this; }
        public double gyro_bias_b(int i) { return memory.getDouble(136 + 8 * i); }
        public double[] gyro_bias_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = gyro_bias_b(i); return values; }
        public Attitude gyro_bias_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(136 + 8 * i, values[i]); return this; }
    }
    public static final class Step extends Struct {
        public static final int SIZE = 96;
        public static final int TYPE = 0x1002;
        public Step(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Step(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Step type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Step t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Step source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Step flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Step quality(float value) { memory.putFloat(24, value); return this; }
        public long t_start_ns() { return memory.getLong(32); }
        public Step t_start_ns(long value) { memory.putLong(32, value); return this; }
        public long t_end_ns() { return memory.getLong(40); }
        public Step t_end_ns(long value) { memory.putLong(40, value); return this; }
        public double length_m() { return memory.getDouble(48); }
        public Step length_m(double value) { memory.putDouble(48, value); return this; }
        public double sigma_m() { return memory.getDouble(56); }
        public Step sigma_m(double value) { memory.putDouble(56, value); return this; }
        public double frequency_hz() { return memory.getDouble(64); }
        public Step frequency_hz(double value) { memory.putDouble(64, value); return this; }
        public double heading_rad() { return memory.getDouble(72); }
        public Step heading_rad(double value) { memory.putDouble(72, value); return this; }
        public int mode() { return memory.getInt(80); }
        public Step mode(int value) { memory.putInt(80, value); return this; }
        public int index() { return memory.getInt(84); }
        public Step index(int value) { memory.putInt(84, value); return this; }
        public double heading_sigma_rad() { return memory.getDouble(88); }
        public Step heading_sigma_rad(double value) { memory.putDouble(88, value); return this; }
    }
    public static final class MotionMode extends Struct {
        public static final int SIZE = 40;
        public static final int TYPE = 0x1003;
        public MotionMode(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public MotionMode(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public MotionMode type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public MotionMode t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public MotionMode source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public MotionMode flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public MotionMode quality(float value) { memory.putFloat(24, value); return this; }
        public int mode() { return memory.getInt(32); }
        public MotionMode mode(int value) { memory.putInt(32, value); return this; }
    }
    public static final class VoMotion extends Struct {
        public static final int SIZE = 544;
        public static final int TYPE = 0x1004;
        public VoMotion(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public VoMotion(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public VoMotion type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public VoMotion t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public VoMotion source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public VoMotion flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public VoMotion quality(float value) { memory.putFloat(24, value); return this; }
        public long t_from_ns() { return memory.getLong(32); }
        public VoMotion t_from_ns(long value) { memory.putLong(32, value); return this; }
        public double q_c0_c1(int i) { return memory.getDouble(40 + 8 * i); }
        public double[] q_c0_c1() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_c0_c1(i); return values; }
        public VoMotion q_c0_c1(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(40 + 8 * i, values[i]); return this; }
        public double p_c0_c1(int i) { return memory.getDouble(72 + 8 * i); }
        public double[] p_c0_c1() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_c0_c1(i); return values; }
        public VoMotion p_c0_c1(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(72 + 8 * i, values[i]); return this; }
        public double covariance(int i) { return memory.getDouble(96 + 8 * i); }
        public double[] covariance() { double[] values = new double[36]; for (int i = 0; i < 36; ++i) values[i] = covariance(i); return values; }
        public VoMotion covariance(double... values) { for (int i = 0; i < 36; ++i) memory.putDouble(96 + 8 * i, values[i]); return this; }
        public double q_n_c0(int i) { return memory.getDouble(384 + 8 * i); }
        public double[] q_n_c0() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n_c0(i); return values; }
        public VoMotion q_n_c0(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(384 + 8 * i, values[i]); return this; }
        public int camera() { return memory.getInt(416); }
        public VoMotion camera(int value) { memory.putInt(416, value); return this; }
        public int state() { return memory.getInt(420); }
        public VoMotion state(int value) { memory.putInt(420, value); return this; }
        public int reason() { return memory.getInt(424); }
        public VoMotion reason(int value) { memory.putInt(424, value); return this; }
        public int scale_group() { return memory.getInt(428); }
        public VoMotion scale_group(int value) { memory.putInt(428, value); return this; }
        public int tracked() { return memory.getInt(432); }
        public VoMotion tracked(int value) { memory.putInt(432, value); return this; }
        public int inliers() { return memory.getInt(436); }
        public VoMotion inliers(int value) { memory.putInt(436, value); return this; }
        public double scale_sigma() { return memory.getDouble(440); }
        public VoMotion scale_sigma(double value) { memory.putDouble(440, value); return this; }
        public double velocity_c1(int i) { return memory.getDouble(448 + 8 * i); }
        public double[] velocity_c1() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = velocity_c1(i); return values; }
        public VoMotion velocity_c1(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(448 + 8 * i, values[i]); return this; }
        public double gravity_c1(int i) { return memory.getDouble(472 + 8 * i); }
        public double[] gravity_c1() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = gravity_c1(i); return values; }
        public VoMotion gravity_c1(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(472 + 8 * i, values[i]); return this; }
        public double gyro_bias_b(int i) { return memory.getDouble(496 + 8 * i); }
        public double[] gyro_bias_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = gyro_bias_b(i); return values; }
        public VoMotion gyro_bias_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(496 + 8 * i, values[i]); return this; }
        public double accel_bias_b(int i) { return memory.getDouble(520 + 8 * i); }
        public double[] accel_bias_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = accel_bias_b(i); return values; }
        public VoMotion accel_bias_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(520 + 8 * i, values[i]); return this; }
    }
    public static final class Scale extends Struct {
        public static final int SIZE = 80;
        public static final int TYPE = 0x1005;
        public Scale(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Scale(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Scale type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Scale t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Scale source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Scale flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Scale quality(float value) { memory.putFloat(24, value); return this; }
        public long valid_from_ns() { return memory.getLong(32); }
        public Scale valid_from_ns(long value) { memory.putLong(32, value); return this; }
        public long valid_to_ns() { return memory.getLong(40); }
        public Scale valid_to_ns(long value) { memory.putLong(40, value); return this; }
        public double scale() { return memory.getDouble(48); }
        public Scale scale(double value) { memory.putDouble(48, value); return this; }
        public double sigma() { return memory.getDouble(56); }
        public Scale sigma(double value) { memory.putDouble(56, value); return this; }
        public double displacement_m() { return memory.getDouble(64); }
        public Scale displacement_m(double value) { memory.putDouble(64, value); return this; }
        public int scale_group() { return memory.getInt(72); }
        public Scale scale_group(int value) { memory.putInt(72, value); return this; }
    }
    public static final class Fix extends Struct {
        public static final int SIZE = 440;
        public static final int TYPE = 0x1006;
        public Fix(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Fix(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Fix type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Fix t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Fix source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Fix flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Fix quality(float value) { memory.putFloat(24, value); return this; }
        public double p_n(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Fix p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double covariance_n(int i) { return memory.getDouble(56 + 8 * i); }
        public double[] covariance_n() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = covariance_n(i); return values; }
        public Fix covariance_n(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(56 + 8 * i, values[i]); return this; }
        public double q_n_b(int i) { return memory.getDouble(128 + 8 * i); }
        public double[] q_n_b() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n_b(i); return values; }
        public Fix q_n_b(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(128 + 8 * i, values[i]); return this; }
        public double orientation_cov_n(int i) { return memory.getDouble(160 + 8 * i); }
        public double[] orientation_cov_n() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = orientation_cov_n(i); return values; }
        public Fix orientation_cov_n(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(160 + 8 * i, values[i]); return this; }
        public double yaw_rad() { return memory.getDouble(232); }
        public Fix yaw_rad(double value) { memory.putDouble(232, value); return this; }
        public double yaw_sigma_rad() { return memory.getDouble(240); }
        public Fix yaw_sigma_rad(double value) { memory.putDouble(240, value); return this; }
        public double latitude_rad() { return memory.getDouble(248); }
        public Fix latitude_rad(double value) { memory.putDouble(248, value); return this; }
        public double longitude_rad() { return memory.getDouble(256); }
        public Fix longitude_rad(double value) { memory.putDouble(256, value); return this; }
        public double height_m() { return memory.getDouble(264); }
        public Fix height_m(double value) { memory.putDouble(264, value); return this; }
        public double integrity() { return memory.getDouble(272); }
        public Fix integrity(double value) { memory.putDouble(272, value); return this; }
        public double landmark_n(int i) { return memory.getDouble(280 + 8 * i); }
        public double[] landmark_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = landmark_n(i); return values; }
        public Fix landmark_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(280 + 8 * i, values[i]); return this; }
        public double slant_distance_m() { return memory.getDouble(304); }
        public Fix slant_distance_m(double value) { memory.putDouble(304, value); return this; }
        public double lever_b(int i) { return memory.getDouble(312 + 8 * i); }
        public double[] lever_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = lever_b(i); return values; }
        public Fix lever_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(312 + 8 * i, values[i]); return this; }
        public double yaw_axis_b(int i) { return memory.getDouble(336 + 8 * i); }
        public double[] yaw_axis_b() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = yaw_axis_b(i); return values; }
        public Fix yaw_axis_b(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(336 + 8 * i, values[i]); return this; }
        public double cross_covariance_n(int i) { return memory.getDouble(360 + 8 * i); }
        public double[] cross_covariance_n() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = cross_covariance_n(i); return values; }
        public Fix cross_covariance_n(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(360 + 8 * i, values[i]); return this; }
        public double slant_sigma_m() { return memory.getDouble(432); }
        public Fix slant_sigma_m(double value) { memory.putDouble(432, value); return this; }
    }
    public static final class Pose extends Struct {
        public static final int SIZE = 544;
        public static final int TYPE = 0x1007;
        public Pose(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Pose(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Pose type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Pose t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Pose source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Pose flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Pose quality(float value) { memory.putFloat(24, value); return this; }
        public double q_n(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] q_n() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n(i); return values; }
        public Pose q_n(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double p_n(int i) { return memory.getDouble(64 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Pose p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(64 + 8 * i, values[i]); return this; }
        public double velocity_n(int i) { return memory.getDouble(88 + 8 * i); }
        public double[] velocity_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = velocity_n(i); return values; }
        public Pose velocity_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(88 + 8 * i, values[i]); return this; }
        public double covariance(int i) { return memory.getDouble(112 + 8 * i); }
        public double[] covariance() { double[] values = new double[36]; for (int i = 0; i < 36; ++i) values[i] = covariance(i); return values; }
        public Pose covariance(double... values) { for (int i = 0; i < 36; ++i) memory.putDouble(112 + 8 * i, values[i]); return this; }
        public double scale() { return memory.getDouble(400); }
        public Pose scale(double value) { memory.putDouble(400, value); return this; }
        public double scale_sigma() { return memory.getDouble(408); }
        public Pose scale_sigma(double value) { memory.putDouble(408, value); return this; }
        public double distance_m() { return memory.getDouble(416); }
        public Pose distance_m(double value) { memory.putDouble(416, value); return this; }
        public int state() { return memory.getInt(424); }
        public Pose state(int value) { memory.putInt(424, value); return this; }
        public int reason() { return memory.getInt(428); }
        public Pose reason(int value) { memory.putInt(428, value); return this; }
        public double angular_velocity(int i) { return memory.getDouble(432 + 8 * i); }
        public double[] angular_velocity() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = angular_velocity(i); return values; }
        public Pose angular_velocity(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(432 + 8 * i, values[i]); return this; }
        public double velocity_covariance(int i) { return memory.getDouble(456 + 8 * i); }
        public double[] velocity_covariance() { double[] values = new double[9]; for (int i = 0; i < 9; ++i) values[i] = velocity_covariance(i); return values; }
        public Pose velocity_covariance(double... values) { for (int i = 0; i < 9; ++i) memory.putDouble(456 + 8 * i, values[i]); return this; }
        public int floor() { return memory.getInt(528); }
        public Pose floor(int value) { memory.putInt(528, value); return this; }
        public double floor_probability() { return memory.getDouble(536); }
        public Pose floor_probability(double value) { memory.putDouble(536, value); return this; }
    }
    public static final class State extends Struct {
        public static final int SIZE = 40;
        public static final int TYPE = 0x1008;
        public State(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public State(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public State type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public State t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public State source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public State flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public State quality(float value) { memory.putFloat(24, value); return this; }
        public int state() { return memory.getInt(32); }
        public State state(int value) { memory.putInt(32, value); return this; }
        public int reason() { return memory.getInt(36); }
        public State reason(int value) { memory.putInt(36, value); return this; }
    }
    public static final class Correction extends Struct {
        public static final int SIZE = 96;
        public static final int TYPE = 0x1009;
        public Correction(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Correction(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Correction type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Correction t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Correction source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Correction flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Correction quality(float value) { memory.putFloat(24, value); return this; }
        public double q_n(int i) { return memory.getDouble(32 + 8 * i); }
        public double[] q_n() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n(i); return values; }
        public Correction q_n(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(32 + 8 * i, values[i]); return this; }
        public double p_n(int i) { return memory.getDouble(64 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Correction p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(64 + 8 * i, values[i]); return this; }
        public int reason() { return memory.getInt(88); }
        public Correction reason(int value) { memory.putInt(88, value); return this; }
    }
    public static final class Report extends Struct {
        public static final int SIZE = 1200;
        public static final int TYPE = 0x100a;
        public Report(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Report(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Report type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Report t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Report source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Report flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Report quality(float value) { memory.putFloat(24, value); return this; }
        public long count() { return memory.getLong(32); }
        public Report count(long value) { memory.putLong(32, value); return this; }
        public int severity() { return memory.getInt(40); }
        public Report severity(int value) { memory.putInt(40, value); return this; }
        public int status() { return memory.getInt(44); }
        public Report status(int value) { memory.putInt(44, value); return this; }
        public String plugin() { return text(48, 64); }
        public String key() { return text(112, 64); }
        public String text() { return text(176, 1024); }
    }
    public static final class Refined extends Struct {
        public static final int SIZE = 224;
        public static final int TYPE = 0x100b;
        public Refined(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public Refined(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public Refined type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public Refined t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public Refined source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public Refined flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public Refined quality(float value) { memory.putFloat(24, value); return this; }
        public int camera() { return memory.getInt(32); }
        public Refined camera(int value) { memory.putInt(32, value); return this; }
        public int model() { return memory.getInt(36); }
        public Refined model(int value) { memory.putInt(36, value); return this; }
        public int width() { return memory.getInt(40); }
        public Refined width(int value) { memory.putInt(40, value); return this; }
        public int height() { return memory.getInt(44); }
        public Refined height(int value) { memory.putInt(44, value); return this; }
        public int distortion_count() { return memory.getInt(48); }
        public Refined distortion_count(int value) { memory.putInt(48, value); return this; }
        public double fx() { return memory.getDouble(56); }
        public Refined fx(double value) { memory.putDouble(56, value); return this; }
        public double fy() { return memory.getDouble(64); }
        public Refined fy(double value) { memory.putDouble(64, value); return this; }
        public double cx() { return memory.getDouble(72); }
        public Refined cx(double value) { memory.putDouble(72, value); return this; }
        public double cy() { return memory.getDouble(80); }
        public Refined cy(double value) { memory.putDouble(80, value); return this; }
        public double distortion(int i) { return memory.getDouble(88 + 8 * i); }
        public double[] distortion() { double[] values = new double[8]; for (int i = 0; i < 8; ++i) values[i] = distortion(i); return values; }
        public Refined distortion(double... values) { for (int i = 0; i < 8; ++i) memory.putDouble(88 + 8 * i, values[i]); return this; }
        public double q_b_c(int i) { return memory.getDouble(152 + 8 * i); }
        public double[] q_b_c() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_b_c(i); return values; }
        public Refined q_b_c(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(152 + 8 * i, values[i]); return this; }
        public double p_b_c(int i) { return memory.getDouble(184 + 8 * i); }
        public double[] p_b_c() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_b_c(i); return values; }
        public Refined p_b_c(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(184 + 8 * i, values[i]); return this; }
        public long time_offset_ns() { return memory.getLong(208); }
        public Refined time_offset_ns(long value) { memory.putLong(208, value); return this; }
        public long line_time_ns() { return memory.getLong(216); }
        public Refined line_time_ns(long value) { memory.putLong(216, value); return this; }
    }
    public static final class RelativePose extends Struct {
        public static final int SIZE = 384;
        public static final int TYPE = 0x100c;
        public RelativePose(long t_ns) { super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }
        public RelativePose(Event event) { super(SIZE); copy(event, TYPE); }
        public int type() { return memory.getInt(4); }
        public RelativePose type(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public RelativePose t_ns(long value) { memory.putLong(8, value); return this; }
        public int source() { return memory.getInt(16); }
        public RelativePose source(int value) { memory.putInt(16, value); return this; }
        public int flags() { return memory.getInt(20); }
        public RelativePose flags(int value) { memory.putInt(20, value); return this; }
        public float quality() { return memory.getFloat(24); }
        public RelativePose quality(float value) { memory.putFloat(24, value); return this; }
        public long t_from_ns() { return memory.getLong(32); }
        public RelativePose t_from_ns(long value) { memory.putLong(32, value); return this; }
        public double q_b0_b1(int i) { return memory.getDouble(40 + 8 * i); }
        public double[] q_b0_b1() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_b0_b1(i); return values; }
        public RelativePose q_b0_b1(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(40 + 8 * i, values[i]); return this; }
        public double p_b0_b1(int i) { return memory.getDouble(72 + 8 * i); }
        public double[] p_b0_b1() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_b0_b1(i); return values; }
        public RelativePose p_b0_b1(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(72 + 8 * i, values[i]); return this; }
        public double covariance(int i) { return memory.getDouble(96 + 8 * i); }
        public double[] covariance() { double[] values = new double[36]; for (int i = 0; i < 36; ++i) values[i] = covariance(i); return values; }
        public RelativePose covariance(double... values) { for (int i = 0; i < 36; ++i) memory.putDouble(96 + 8 * i, values[i]); return this; }
    }
    public static final class SessionOptions extends Struct {
        public static final int SIZE = 104;
        public SessionOptions() { super(SIZE); }
        public int run() { return memory.getInt(4); }
        public SessionOptions run(int value) { memory.putInt(4, value); return this; }
        public long config_path_data() { return memory.getLong(8); }
        public SessionOptions config_path_data(long value) { memory.putLong(8, value); return this; }
        public long config_path_size() { return memory.getLong(16); }
        public SessionOptions config_path_size(long value) { memory.putLong(16, value); return this; }
        public long config_text_data() { return memory.getLong(24); }
        public SessionOptions config_text_data(long value) { memory.putLong(24, value); return this; }
        public long config_text_size() { return memory.getLong(32); }
        public SessionOptions config_text_size(long value) { memory.putLong(32, value); return this; }
        public long plugin_path_data() { return memory.getLong(40); }
        public SessionOptions plugin_path_data(long value) { memory.putLong(40, value); return this; }
        public long plugin_path_size() { return memory.getLong(48); }
        public SessionOptions plugin_path_size(long value) { memory.putLong(48, value); return this; }
        public long seed() { return memory.getLong(56); }
        public SessionOptions seed(long value) { memory.putLong(56, value); return this; }
        public long asset_path_data() { return memory.getLong(64); }
        public SessionOptions asset_path_data(long value) { memory.putLong(64, value); return this; }
        public long asset_path_size() { return memory.getLong(72); }
        public SessionOptions asset_path_size(long value) { memory.putLong(72, value); return this; }
        public int flags() { return memory.getInt(80); }
        public SessionOptions flags(int value) { memory.putInt(80, value); return this; }
        public long user() { return memory.getLong(88); }
        public SessionOptions user(long value) { memory.putLong(88, value); return this; }
        public long get_service() { return memory.getLong(96); }
        public SessionOptions get_service(long value) { memory.putLong(96, value); return this; }
    }
    public static final class Statistics extends Struct {
        public static final int SIZE = 184;
        public Statistics() { super(SIZE); }
        public long pushed() { return memory.getLong(8); }
        public Statistics pushed(long value) { memory.putLong(8, value); return this; }
        public long processed() { return memory.getLong(16); }
        public Statistics processed(long value) { memory.putLong(16, value); return this; }
        public long frames() { return memory.getLong(24); }
        public Statistics frames(long value) { memory.putLong(24, value); return this; }
        public long steps() { return memory.getLong(32); }
        public Statistics steps(long value) { memory.putLong(32, value); return this; }
        public long fixes_accepted() { return memory.getLong(40); }
        public Statistics fixes_accepted(long value) { memory.putLong(40, value); return this; }
        public long fixes_rejected() { return memory.getLong(48); }
        public Statistics fixes_rejected(long value) { memory.putLong(48, value); return this; }
        public long late() { return memory.getLong(56); }
        public Statistics late(long value) { memory.putLong(56, value); return this; }
        public long duplicate() { return memory.getLong(64); }
        public Statistics duplicate(long value) { memory.putLong(64, value); return this; }
        public long invalid() { return memory.getLong(72); }
        public Statistics invalid(long value) { memory.putLong(72, value); return this; }
        public long overflow() { return memory.getLong(80); }
        public Statistics overflow(long value) { memory.putLong(80, value); return this; }
        public long gaps() { return memory.getLong(88); }
        public Statistics gaps(long value) { memory.putLong(88, value); return this; }
        public long plugin_faults() { return memory.getLong(96); }
        public Statistics plugin_faults(long value) { memory.putLong(96, value); return this; }
        public double tracking_s() { return memory.getDouble(104); }
        public Statistics tracking_s(double value) { memory.putDouble(104, value); return this; }
        public double degraded_s() { return memory.getDouble(112); }
        public Statistics degraded_s(double value) { memory.putDouble(112, value); return this; }
        public double lost_s() { return memory.getDouble(120); }
        public Statistics lost_s(double value) { memory.putDouble(120, value); return this; }
        public double distance_m() { return memory.getDouble(128); }
        public Statistics distance_m(double value) { memory.putDouble(128, value); return this; }
        public long wild() { return memory.getLong(136); }
        public Statistics wild(long value) { memory.putLong(136, value); return this; }
        public long events_dropped() { return memory.getLong(144); }
        public Statistics events_dropped(long value) { memory.putLong(144, value); return this; }
        public long unknown() { return memory.getLong(152); }
        public Statistics unknown(long value) { memory.putLong(152, value); return this; }
        public double scale_sigma() { return memory.getDouble(160); }
        public Statistics scale_sigma(double value) { memory.putDouble(160, value); return this; }
        public double scale_by_inertia() { return memory.getDouble(168); }
        public Statistics scale_by_inertia(double value) { memory.putDouble(168, value); return this; }
        public double scale_by_steps() { return memory.getDouble(176); }
        public Statistics scale_by_steps(double value) { memory.putDouble(176, value); return this; }
    }
    public static final class AnchorPlace extends Struct {
        public static final int SIZE = 136;
        public AnchorPlace() { super(SIZE); }
        public int kind() { return memory.getInt(4); }
        public AnchorPlace kind(int value) { memory.putInt(4, value); return this; }
        public long t_ns() { return memory.getLong(8); }
        public AnchorPlace t_ns(long value) { memory.putLong(8, value); return this; }
        public int world() { return memory.getInt(16); }
        public AnchorPlace world(int value) { memory.putInt(16, value); return this; }
        public int height_above() { return memory.getInt(20); }
        public AnchorPlace height_above(int value) { memory.putInt(20, value); return this; }
        public double q(int i) { return memory.getDouble(24 + 8 * i); }
        public double[] q() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q(i); return values; }
        public AnchorPlace q(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(24 + 8 * i, values[i]); return this; }
        public double p(int i) { return memory.getDouble(56 + 8 * i); }
        public double[] p() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p(i); return values; }
        public AnchorPlace p(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(56 + 8 * i, values[i]); return this; }
        public double latitude_rad() { return memory.getDouble(80); }
        public AnchorPlace latitude_rad(double value) { memory.putDouble(80, value); return this; }
        public double longitude_rad() { return memory.getDouble(88); }
        public AnchorPlace longitude_rad(double value) { memory.putDouble(88, value); return this; }
        public double height_m() { return memory.getDouble(96); }
        public AnchorPlace height_m(double value) { memory.putDouble(96, value); return this; }
        public double geoid_height_m() { return memory.getDouble(104); }
        public AnchorPlace geoid_height_m(double value) { memory.putDouble(104, value); return this; }
        public double sigma_m() { return memory.getDouble(112); }
        public AnchorPlace sigma_m(double value) { memory.putDouble(112, value); return this; }
        public long name_data() { return memory.getLong(120); }
        public AnchorPlace name_data(long value) { memory.putLong(120, value); return this; }
        public long name_size() { return memory.getLong(128); }
        public AnchorPlace name_size(long value) { memory.putLong(128, value); return this; }
    }
    public static final class Anchor extends Struct {
        public static final int SIZE = 264;
        public Anchor() { super(SIZE); }
        public int kind() { return memory.getInt(4); }
        public Anchor kind(int value) { memory.putInt(4, value); return this; }
        public long id() { return memory.getLong(8); }
        public Anchor id(long value) { memory.putLong(8, value); return this; }
        public long t_ns() { return memory.getLong(16); }
        public Anchor t_ns(long value) { memory.putLong(16, value); return this; }
        public int flags() { return memory.getInt(24); }
        public Anchor flags(int value) { memory.putInt(24, value); return this; }
        public int state() { return memory.getInt(28); }
        public Anchor state(int value) { memory.putInt(28, value); return this; }
        public int reason() { return memory.getInt(32); }
        public Anchor reason(int value) { memory.putInt(32, value); return this; }
        public double q_n(int i) { return memory.getDouble(40 + 8 * i); }
        public double[] q_n() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_n(i); return values; }
        public Anchor q_n(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(40 + 8 * i, values[i]); return this; }
        public double p_n(int i) { return memory.getDouble(72 + 8 * i); }
        public double[] p_n() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_n(i); return values; }
        public Anchor p_n(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(72 + 8 * i, values[i]); return this; }
        public double q_view(int i) { return memory.getDouble(96 + 8 * i); }
        public double[] q_view() { double[] values = new double[4]; for (int i = 0; i < 4; ++i) values[i] = q_view(i); return values; }
        public Anchor q_view(double... values) { for (int i = 0; i < 4; ++i) memory.putDouble(96 + 8 * i, values[i]); return this; }
        public double p_view(int i) { return memory.getDouble(128 + 8 * i); }
        public double[] p_view() { double[] values = new double[3]; for (int i = 0; i < 3; ++i) values[i] = p_view(i); return values; }
        public Anchor p_view(double... values) { for (int i = 0; i < 3; ++i) memory.putDouble(128 + 8 * i, values[i]); return this; }
        public double position_sigma_m() { return memory.getDouble(152); }
        public Anchor position_sigma_m(double value) { memory.putDouble(152, value); return this; }
        public double yaw_sigma_rad() { return memory.getDouble(160); }
        public Anchor yaw_sigma_rad(double value) { memory.putDouble(160, value); return this; }
        public double view_sigma_m() { return memory.getDouble(168); }
        public Anchor view_sigma_m(double value) { memory.putDouble(168, value); return this; }
        public double latitude_rad() { return memory.getDouble(176); }
        public Anchor latitude_rad(double value) { memory.putDouble(176, value); return this; }
        public double longitude_rad() { return memory.getDouble(184); }
        public Anchor longitude_rad(double value) { memory.putDouble(184, value); return this; }
        public double height_m() { return memory.getDouble(192); }
        public Anchor height_m(double value) { memory.putDouble(192, value); return this; }
        public String name() { return text(200, 64); }
    }
}
