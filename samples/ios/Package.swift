// swift-tools-version:5.9
// SPDX-License-Identifier: Apache-2.0
import PackageDescription

let package = Package(
    name: "OdographPhone",
    platforms: [.iOS(.v16)],
    products: [.library(name: "OdographView", targets: ["OdographView"])],
    targets: [
        .binaryTarget(name: "Odograph", path: "Odograph.xcframework"),  // make_xcframework.sh
        .target(name: "OdographPhone", dependencies: ["Odograph"],
                linkerSettings: [.linkedLibrary("c++"), .linkedFramework("AVFoundation"), .linkedFramework("CoreMotion")]),
        .target(name: "OdographView", dependencies: ["OdographPhone"]),
    ]
)
