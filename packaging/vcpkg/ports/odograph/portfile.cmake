# Not run yet: vcpkg could not be had where this was written; its syntax alone was checked (ctest -R recipes).
# Builds the library and the plugins out of the tree that this file lies in, without the command line.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../../.." ABSOLUTE)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS -DODOGRAPH_TOOLS=OFF -DODOGRAPH_TESTS=OFF -DODOGRAPH_STATIC_DEPENDENCIES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME Odograph CONFIG_PATH lib/cmake/Odograph)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE" "${SOURCE_PATH}/NOTICE")
