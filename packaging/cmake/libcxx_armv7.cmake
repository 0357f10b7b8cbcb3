# SPDX-License-Identifier: Apache-2.0
# 32-bit ARM with clang and libc++, to compile and not to link: the headers are Debian's, its libraries this machine's own.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
include(${CMAKE_CURRENT_LIST_DIR}/libcxx.cmake)
set(CMAKE_C_COMPILER_TARGET arm-linux-gnueabihf)
set(CMAKE_CXX_COMPILER_TARGET arm-linux-gnueabihf)
set(CMAKE_C_FLAGS_INIT "-march=armv7-a -isystem /usr/arm-linux-gnueabihf/include")
string(APPEND CMAKE_CXX_FLAGS_INIT " -march=armv7-a -isystem /usr/arm-linux-gnueabihf/include")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# The word size stays unknown to CMake: packages of 64-bit libraries would refuse it, of which the headers alone are used.
set(CMAKE_C_COMPILER_FORCED TRUE)
set(CMAKE_CXX_COMPILER_FORCED TRUE)
set(CMAKE_CXX_COMPILE_FEATURES cxx_std_11 cxx_std_14 cxx_std_17 cxx_std_20)
# Searched anyhow, last. Named by a package, as GeographicLib's does, it would come before libc++'s own headers.
set(CMAKE_C_IMPLICIT_INCLUDE_DIRECTORIES /usr/include)
set(CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES /usr/include)
set(CMAKE_LIBRARY_ARCHITECTURE x86_64-linux-gnu)
