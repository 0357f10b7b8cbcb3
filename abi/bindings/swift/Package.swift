// swift-tools-version:5.7
// SPDX-License-Identifier: Apache-2.0
// Never built: there is no Swift compiler where this was written. clang compiles the module map (ctest -R languages), nothing else is tried.
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
