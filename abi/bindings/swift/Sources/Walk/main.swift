// Not compiled yet, because no Swift compiler was available.
// SPDX-License-Identifier: Apache-2.0
// A recording read, and a walk tracked live, in Swift: Walk CONFIG.yaml RECORDING.odo
import Foundation
import Odograph

let config = """
odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}

"""

func show(_ event: Event) {
    guard let pose = event.get(odo_pose.self) else { return }
    let (x, y, z) = pose.p_n
    let (qw, qx, qy, qz) = pose.q_n
    print("pose \(pose.header.t_ns) \(x) \(y) \(z) \(qx) \(qy) \(qz) \(qw)")
}

/// Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library.
func decode(_ picture: UnsafeRawBufferPointer, _ frame: inout odo_frame) -> Int {
    let words = String(decoding: picture.prefix(24), as: Unicode.ASCII.self).split(whereSeparator: \.isWhitespace).prefix(4)
    frame.format = ODO_FORMAT_GREY8
    frame.width = UInt32(words[1])!
    frame.height = UInt32(words[2])!
    frame.plane_count = 1
    return words.reduce(0) { $0 + $1.count + 1 }
}

func replay(_ config: String, _ file: String) throws {
    let session = try Session(config: config)
    try session.onEvent([ODO_TYPE_POSE], show)
    let recording = try Recording(file)
    while let (message, picture) = recording.next() {
        if let picture = picture, var frame = message.get(odo_frame.self) {
            let begin = decode(picture, &frame)
            let pixels = NSData(bytes: picture.baseAddress! + begin, length: picture.count - begin)
            frame.planes.0 = odo_plane(data: pixels.bytes.assumingMemoryBound(to: UInt8.self), row_stride: Int64(frame.width), pixel_stride: 1, rows: 0)
            session.push(frame, owner: pixels)
        } else if message.isInput {
            session.push(message)
        }
    }
    try session.flush()
}

func live() throws {
    let session = try Session(config: config, live: true)
    var steps = 0
    try session.onEvent([ODO_TYPE_STEP]) { _ in steps += 1 }
    let pixels = NSData(data: Data(repeating: 90, count: 64 * 48)) // as from a camera
    for i in 0..<1000 {
        let t = Double(i) * 0.01
        let t_ns = 1_000_000_000 + Int64(i) * 10_000_000
        var imu = odo_imu(at: t_ns)
        imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL
        imu.gyro_b = (0, 0.01, 0)
        imu.accel_b = (0.1, 9.81 + 2.2 * sin(12 * t), 0.4)
        session.push(imu)
        guard i % 10 == 0 else { continue }
        var frame = odo_frame(at: t_ns)
        frame.format = ODO_FORMAT_GREY8
        (frame.width, frame.height, frame.plane_count) = (64, 48, 1)
        frame.planes.0 = odo_plane(data: pixels.bytes.assumingMemoryBound(to: UInt8.self), row_stride: 64, pixel_stride: 1, rows: 0)
        session.push(frame, owner: pixels) // shared, not copied
        try session.flush() // needed only because the simulated time does not wait
    }
    let (north, east, down) = session.pose()!.p_n
    var place = odo_anchor_place()
    place.kind = ODO_ANCHOR_VIEW
    place.t_ns = Int64.min
    place.p = (0, 0, -3)
    let (x, y, z) = try session.anchor(session.createAnchor(place, name: "a label")).p_n
    print("live \(steps) steps \(north) \(east) \(down) label", String(format: "%.2f %.2f %.2f", x, y, z))
}

try replay(CommandLine.arguments[1], CommandLine.arguments[2])
try live()
