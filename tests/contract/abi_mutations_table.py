# SPDX-License-Identifier: Apache-2.0
"""Violations of the contract for abi_mutations.py: name, edits (file, text before, text after), the check that must detect it,
and the expected text."""
H = "abi/include/odograph/"
BASE, SAMPLES, EVENTS, APP, PLUGIN = (H + name for name in ("base.h", "samples.h", "events.h", "odograph.h", "plugin.h"))
MAP = "sdk/host/odograph.map"
OUTPUT = "sdk/host/core/pose_publisher.cpp"
WEINBERG = "plugins/step/weinberg2002/plugin.cpp"
CORRECTION = "publish_correction(fusion, *correction);\n"
NEW_POSES = "    publish_pose(fusion, pose, true);\n  }\n"

# Permitted additions.
GROWTH = [
    ("field at a message's end", [(SAMPLES, "  double intensity_t;     /* tesla */", "  double intensity_t;\n  double more;")]),
    ("flag", [(SAMPLES, "#define ODO_RANGE_LEVER 2u", "#define ODO_RANGE_MORE 4u\n#define ODO_RANGE_LEVER 2u")]),
    ("function", [(APP, "ODO_API uint32_t ODO_CALL odo_abi_version(void);", "ODO_API uint32_t ODO_CALL odo_abi_version(void);\nODO_API uint32_t ODO_CALL odo_more(void);"),
                  (MAP, "  local: *;\n};", "  local: *;\n};\nODOGRAPH_1.1 {\n  global:\n    odo_more;\n};")]),
    ("minor version", [(BASE, "ODO_ABI_MINOR 1u", "ODO_ABI_MINOR 2u")]),
]

ROWS = [
    # Not detected by a check of offsets alone.
    ("flag renumbered", [(SAMPLES, "ODO_GNSS_HEIGHT 2u", "ODO_GNSS_HEIGHT 32u")], "contract", "constant ODO_GNSS_HEIGHT: released as '2', now '32'"),
    ("double for int64_t", [(EVENTS, "int64_t valid_from_ns", "double valid_from_ns")], "contract", "field odo_scale.valid_from_ns"),
    ("signature of process", [(PLUGIN, "process, (odo_instance *instance, const odo_batch *batch)", "process, (odo_instance *instance, const odo_batch *batch, uint32_t count)")],
     "contract", "field odo_plugin.process"),
    ("function removed", [(APP, "ODO_API int32_t ODO_CALL odo_session_flush(odo_session *session);", "")], "contract", "function odo_session_flush"),
    ("status code", [(BASE, "ODO_E_DISCARD (-2)", "ODO_E_DISCARD (-22)")], "contract", "constant ODO_E_DISCARD"),
    ("type number", [(BASE, "ODO_TYPE_RANGE 0xAu", "ODO_TYPE_RANGE 0xCu")], "contract", "message odo_range: released as '0xa', now '0xc'"),
    ("interface id", [(H + "attitude.h", "odo.attitude/1", "odo.attitude/2")], "contract", "constant ODO_INTERFACE_ATTITUDE"),
    ("argument of a function pointer", [(BASE, "retain, (void *owner)", "retain, (const void *owner)")], "contract", "field odo_loan.retain"),
    # Constants, macros and names.
    ("bit of the host's mask", [(BASE, "ODO_FLAG_HOST_MASK 0x0F000000u", "ODO_FLAG_HOST_MASK 0x07000000u")], "contract", "constant ODO_FLAG_HOST_MASK"),
    ("ODO_HAS excludes the last field", [(BASE, "sizeof((ptr)->field) <= ", "sizeof((ptr)->field) < ")], "contract", "macro ODO_HAS"),
    ("calling convention dropped", [(APP, "typedef void (ODO_CALL *odo_callback)", "typedef void (*odo_callback)")], "contract", "callback odo_callback"),
    ("entry symbol", [(PLUGIN, '"odo_plugin_entry_v1"', '"odo_plugin_entry_v2"'), (PLUGIN, "#define ODO_PLUGIN_ENTRY odo_plugin_entry_v1", "#define ODO_PLUGIN_ENTRY odo_plugin_entry_v2")],
     "contract", "symbol of the entry"),
    ("const dropped", [(APP, "odo_session_push(odo_session *session, const odo_header *sample)", "odo_session_push(odo_session *session, odo_header *sample)")],
     "contract", "function odo_session_push"),
    ("arguments of one type swapped", [(APP, "const double *gyro_b, const double *accel_b)", "const double *accel_b, const double *gyro_b)")], "contract", "function odo_session_push_imu"),
    # Structs.
    ("order of fields", [(EVENTS, "  uint32_t tracked;", "  uint32_t swapped;"), (EVENTS, "  uint32_t inliers;", "  uint32_t tracked;"), (EVENTS, "uint32_t swapped;", "uint32_t inliers;")],
     "contract", "field odo_vo_motion.inliers"),
    ("length of an array", [(SAMPLES, "  double distortion[8];\n  double q_b_c[4];  ", "  double distortion[6];\n  double q_b_c[4];  ")], "contract", "odo_calibration"),
    ("frozen struct grown", [(BASE, "Frozen at 16 bytes", "Frozen at 24 bytes"), (BASE, "  uint64_t size;                   /* bytes */", "  uint64_t size;\n  uint64_t later;")],
     "contract", "struct odo_string: released as '16 frozen', now '24 frozen'"),
    ("minimum size lowered", [("abi/golden/minimum_v1.txt", "odo_barometer 48", "odo_barometer 40")], "contract", "minimum odo_barometer: released as '48', now '40'"),
    ("pointer appended to a message", [(SAMPLES, "  double intensity_t;     /* tesla */", "  double intensity_t;\n  ODO_POINTER(void *, more);")], "contract", "odo_earth_field: a message that lends no memory has a pointer"),
    ("sign of an integer", [(APP, "  uint64_t gaps; ", "  int64_t gaps; ")], "binary", "gaps"),
    # Targets and symbols.
    ("pointers of 4 bytes", [(BASE, "    type name;                                                                                                         \\\n    uint64_t name##_bits;",
                              "    type name;                                                                                                         \\\n    uint32_t name##_bits;")], "targets", "i386-linux-gnu"),
    ("name missing in the linker's map", [(MAP, "    odo_session_save;\n", "")], "contract", "odo_session_save: declared, but not in odograph.map"),
    # Behaviour of the host.
    ("correction after the pose", [(OUTPUT, CORRECTION, "\n"), (OUTPUT, NEW_POSES, NEW_POSES + "  if (const auto& correction = outputs.correction) " + CORRECTION)], "conformance", "fail  a correction comes before the pose that it corrected"),
    ("host's bits pass in", [("sdk/host/core/intake.cpp", "  copy.header().flags &= ~ODO_FLAG_HOST_MASK;\n", "")], "conformance", "fail  the host's bits are cleared on odo_gnss"),
    ("host's bits pass out", [("sdk/host/plugin_host/instance.cpp", "  copy.header().flags &= ~ODO_FLAG_HOST_MASK;\n", "")], "conformance", "fail  a vendor's event is published with its bytes, its source and without the host's bits"),
    ("default of a key", [("sdk/host/config/pipeline_spec.cpp", 'real("max_wait", "s", 0, 5, "0.2"', 'real("max_wait", "s", 0, 5, "0.3"')], "config", "max_wait"),
    ("default of a parameter", [(WEINBERG, "double k = 0.42", "double k = 0.43")], "config", "parameter step/weinberg2002.k"),
    ("unit of a parameter", [(WEINBERG, 'odo::real("relative_sigma", ""', 'odo::real("relative_sigma", "m"')], "config", "parameter step/weinberg2002.relative_sigma"),
]
