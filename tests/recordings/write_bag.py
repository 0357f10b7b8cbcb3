# SPDX-License-Identifier: Apache-2.0
"""write_bag.py EUROC BAG none|bz2|lz4: writes a ROS 1 bag of an EuRoC folder's camera and IMU by ROS 1's own Python. 77 if it is not installed."""
import csv
import os
import sys

try:
    import rosbag
    import rospy
    from sensor_msgs.msg import CompressedImage, Imu
except ImportError:
    sys.exit(77)

folder, bag_name, compression = sys.argv[1:]


def rows(name):
    with open(os.path.join(folder, "mav0", name), encoding="utf-8", newline="") as file:
        return [row for row in csv.reader(file) if not row[0].startswith("#")]


def stamped(message, t_ns, frame):
    message.header.stamp = rospy.Time(int(t_ns) // 10**9, int(t_ns) % 10**9)
    message.header.frame_id = frame
    return message


with rosbag.Bag(bag_name, "w", compression=compression, chunk_threshold=200_000) as bag:
    for t_ns, name in rows("cam0/data.csv"):
        image = stamped(CompressedImage(format="png"), t_ns, "camera")
        with open(os.path.join(folder, "mav0/cam0/data", name.strip()), "rb") as file:
            image.data = file.read()
        bag.write("/camera/image_raw/compressed", image, image.header.stamp)
    for t_ns, *values in rows("imu0/data.csv"):
        imu = stamped(Imu(), t_ns, "imu")
        gyro, accel = imu.angular_velocity, imu.linear_acceleration
        gyro.x, gyro.y, gyro.z, accel.x, accel.y, accel.z = map(float, values[:6])
        imu.orientation_covariance[0] = -1
        bag.write("/imu/data", imu, imu.header.stamp)
