# SPDX-License-Identifier: Apache-2.0
# Ceres without ATLAS. Debian's Ceres::ceres and its SuiteSparse name ATLAS beside LAPACK and BLAS, for which every system
# has its choice of implementation. Nothing calls ATLAS's own, but its library would be needed at run time.
if(NOT DEFINED BLA_VENDOR)
  set(BLA_VENDOR Generic)
  find_package(BLAS QUIET)
  if(NOT BLAS_FOUND)
    unset(BLA_VENDOR)
  endif()
endif()
find_package(Ceres 2 REQUIRED)
get_target_property(libraries Ceres::ceres INTERFACE_LINK_LIBRARIES)
if(libraries)
  list(FILTER libraries EXCLUDE REGEX "/lib(f77blas|atlas)\\.so$")
  set_target_properties(Ceres::ceres PROPERTIES INTERFACE_LINK_LIBRARIES "${libraries}")
endif()
