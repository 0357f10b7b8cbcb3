# SPDX-License-Identifier: Apache-2.0
# odograph_find_opencv(core imgproc ...): targets opencv_core, ... from OpenCV's own config where there is one, otherwise
# from the libraries alone: Debian puts the config into libopencv-dev, which pulls in all of OpenCV with its contrib
# modules, Java and 300 packages, while the modules' own -dev packages are enough for us.
function(odograph_find_opencv)
  find_package(OpenCV 4 QUIET COMPONENTS ${ARGN})
  if(OpenCV_FOUND)
    return()
  endif()
  find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(module ${ARGN})
    if(NOT TARGET opencv_${module})
      find_library(OPENCV_${module} opencv_${module} REQUIRED)
      add_library(opencv_${module} UNKNOWN IMPORTED GLOBAL)
      set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${OPENCV_${module}}
                            INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE})
    endif()
  endforeach()
endfunction()
