# Not run yet: Conan could not be had where this was written; its syntax alone was checked (ctest -R recipes).
# SPDX-License-Identifier: Apache-2.0
import os

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy


class Odograph(ConanFile):
    name = "odograph"
    version = "1.0.0"
    description = "Metric 6-DoF pose from a hand-held phone's sensors, plugin by plugin"
    license = "Apache-2.0"
    package_type = "shared-library"
    settings = "os", "arch", "compiler", "build_type"
    # The library and the plugins, without the command line; libmd and AprilTag are the system's.
    requires = "eigen/3.4.0", "yaml-cpp/0.7.0", "geographiclib/2.2", "opencv/4.8.1", "ceres-solver/2.1.0", "dlib/19.24", "libtiff/4.6.0"

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "LICENSE", "NOTICE", "abi/*", "sdk/*", "plugins/*", "packaging/*", "samples/*", "schemas/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update(ODOGRAPH_TOOLS=False, ODOGRAPH_TESTS=False, ODOGRAPH_STATIC_DEPENDENCIES=False)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        for name in ("LICENSE", "NOTICE"):
            copy(self, name, self.source_folder, os.path.join(self.package_folder, "licenses"))

    def package_info(self):
        self.cpp_info.libs = ["odograph"]
        self.cpp_info.set_property("cmake_file_name", "Odograph")
        self.cpp_info.set_property("cmake_target_name", "Odograph::odograph")
