# SPDX-License-Identifier: Apache-2.0
# 32-bit ARM Linux (armv7-a, hard float) with Debian's cross compiler over the sysroot that `packaging/targets armv7` unpacks; what the
# build itself runs (manifests, tests) is run by qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(triplet arm-linux-gnueabihf)
set(CMAKE_LIBRARY_ARCHITECTURE ${triplet})
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi) # notes about GCC before 7.1
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm-static;-L;${CMAKE_SYSROOT})
