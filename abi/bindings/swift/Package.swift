// swift-tools-version:5.7
// SPDX-License-Identifier: Apache-2.0
// Not built yet, because no Swift compiler was available. clang compiles the module map (ctest -R languages); nothing else is tested.
import PackageDescription

let package = Package(
    name: "Odograph",
    products: [.library(name: "Odograph", targets: ["Odograph"])],
    targets: [
        .systemLibrary(name: "COdograph", pkgConfig: "odograph"),
        .target(name: "Odograph", dependencies: ["COdograph"]),
        .executableTarget(name: "Walk", dependencies: ["Odograph"]),
    ]
)
