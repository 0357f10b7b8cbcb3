// SPDX-License-Identifier: Apache-2.0
//
// Results kept with the tests: docs/testing.md, "Kept results".
#pragma once

#include "tests/support/support.hpp"

#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#include <doctest/doctest.h>
#include <opencv2/core/version.hpp>

#include "tests/support/digest.hpp"
#include "tests/support/support.hpp"

/// Kept for one kind of machine and one set of libraries: elsewhere the last digits differ, and with them the choice of
/// RANSAC. ctest disables processor features beyond the baseline. ODOGRAPH_COMPARE_KEPT=1 compares on any machine.
inline bool kept_for_this_machine() {
#if defined(__x86_64__) && defined(__GLIBC__)
  const std::string here = "x86-64, glibc " + std::string(gnu_get_libc_version()) + ", OpenCV " + CV_VERSION;
#else
  const std::string here = "another machine";
#endif
  const std::string kept = "x86-64, glibc 2.36, OpenCV 4.6.0";
  if (std::getenv("GLIBC_TUNABLES") == nullptr || std::getenv("OPENCV_CPU_DISABLE") == nullptr)
    FAIL("ctest sets the environment that these results were kept in");
  const bool compared = here == kept || std::getenv("ODOGRAPH_COMPARE_KEPT") != nullptr;
  if (!compared) skip("results are kept for " + kept + "; here is " + here);
  return compared;
}

/// Compares with the result kept under that name; with ODOGRAPH_KEEP_RESULTS in the environment writes it instead.
inline void compare_kept(const std::string& name, const std::string& now, Tolerance tolerance) {
  const auto file = source("tests/kept_results") / (name + ".txt");
  if (std::getenv("ODOGRAPH_KEEP_RESULTS") != nullptr) {
    write_text(file, now);
    return;
  }
  for (const std::string& difference : differences(read_text(file), now, tolerance)) FAIL_CHECK(name, ": ", difference);
}
