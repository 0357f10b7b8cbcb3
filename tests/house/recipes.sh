#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Licences of all files by reuse; recipes of vcpkg and Conan as far as they can be checked without these tools.
set -eu
cd "$1"
command -v reuse > /dev/null || { echo "SKIPPED: no reuse"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
reuse lint > "$work/said" 2>&1 || { cat "$work/said"; exit 1; }
if grep ERROR "$work/said"; then exit 1; fi
python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' packaging/conan/conanfile.py
python3 -m json.tool packaging/vcpkg/ports/odograph/vcpkg.json > /dev/null
# Each command of the port exists in vcpkg and has valid arguments.
cat > "$work/port.cmake" << END
foreach(command vcpkg_cmake_configure vcpkg_cmake_install vcpkg_cmake_config_fixup vcpkg_fixup_pkgconfig vcpkg_install_copyright)
  cmake_language(EVAL CODE "function(\${command})\nendfunction()")
endforeach()
set(CURRENT_PACKAGES_DIR $work/none)
include($PWD/packaging/vcpkg/ports/odograph/portfile.cmake)
if(NOT EXISTS \${SOURCE_PATH}/sdk/host)
  message(FATAL_ERROR "the port builds \${SOURCE_PATH}")
endif()
END
cmake -P "$work/port.cmake"
