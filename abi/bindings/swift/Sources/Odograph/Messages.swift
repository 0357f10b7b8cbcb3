// Not compiled yet, because no Swift compiler was available.
// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
import COdograph

extension odo_imu: Message { public static var type: UInt32 { 0x1 } }
extension odo_magnetometer: Message { public static var type: UInt32 { 0x2 } }
extension odo_barometer: Message { public static var type: UInt32 { 0x3 } }
extension odo_gnss: Message { public static var type: UInt32 { 0x4 } }
extension odo_calibration: Message { public static var type: UInt32 { 0x5 } }
extension odo_imu_noise: Message { public static var type: UInt32 { 0x6 } }
extension odo_waypoint: Message { public static var type: UInt32 { 0x7 } }
extension odo_earth_field: Message { public static var type: UInt32 { 0x8 } }
extension odo_platform_pose: Message { public static var type: UInt32 { 0x9 } }
extension odo_range: Message { public static var type: UInt32 { 0xa } }
extension odo_system_step: Message { public static var type: UInt32 { 0xb } }
extension odo_frame: Message { public static var type: UInt32 { 0x801 } }
extension odo_attitude: Message { public static var type: UInt32 { 0x1001 } }
extension odo_step: Message { public static var type: UInt32 { 0x1002 } }
extension odo_motion_mode: Message { public static var type: UInt32 { 0x1003 } }
extension odo_vo_motion: Message { public static var type: UInt32 { 0x1004 } }
extension odo_scale: Message { public static var type: UInt32 { 0x1005 } }
extension odo_fix: Message { public static var type: UInt32 { 0x1006 } }
extension odo_pose: Message { public static var type: UInt32 { 0x1007 } }
extension odo_state: Message { public static var type: UInt32 { 0x1008 } }
extension odo_correction: Message { public static var type: UInt32 { 0x1009 } }
extension odo_report: Message { public static var type: UInt32 { 0x100a } }
extension odo_refined: Message { public static var type: UInt32 { 0x100b } }
extension odo_relative_pose: Message { public static var type: UInt32 { 0x100c } }
