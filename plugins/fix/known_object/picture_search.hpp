// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/features2d.hpp>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// Finds pictures of known objects in a frame: SIFT (Lowe, IJCV 60, 2004) of the picture in frontal and oblique views
/// (after ASIFT: Morel & Yu, SIAM J. Imaging Sci. 2, 2009), a homography by RANSAC, and its two poses of a plane (IPPE:
/// Collins & Bartoli, IJCV 109, 2014). Not thread-safe.
class PictureSearch {
 public:
  struct Parameters {
    int frame_features = 1200, picture_features = 350;  ///< of the frame; of each view of a picture
    double longest_px = 512;                            ///< pictures are scaled to this
    double ratio = 0.8;         ///< of the distances to the best and to the second-best match elsewhere (Lowe)
    double inlier_px = 3;       ///< of the homography
    int min_inliers = 7;        ///< empirical; the alignment decides
    size_t max_places = 3;      ///< max positions of one picture in one frame
    double contrast = 0.02;     ///< SIFT threshold, half of Lowe's: for small and dim pictures
    float other_place = 0.05F;  ///< of the object's longer side: features closer than this are one position; empirical
  };
  PictureSearch(const Parameters& parameters, const std::vector<PlaneObject>& objects);

  /// Features of one frame, computed once for all objects.
  struct Features {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    std::vector<cv::Point2d> normalised;
  };
  Features look(const cv::Mat& grey, const cv::Mat& mask, const CameraModel& camera) const;

  /// A candidate position of an object in the frame, with up to two poses.
  struct Place {
    std::vector<Pose> poses;
    int inliers = 0;
  };
  std::vector<Place> find(size_t object, const Features& features, const CameraModel& camera) const;

 private:
  struct Known {
    std::vector<cv::Point2f> points_m;  // of each descriptor, in o
    cv::Mat descriptors;
  };
  Parameters p_;
  std::vector<PlaneObject> objects_;
  std::vector<Known> known_;
};

/// Poses of a plane from points (in o, z = 0) and their normalised coordinates, the better one first; empty if there is
/// none in front of the camera.
std::vector<Pose> plane_poses(const std::vector<cv::Point3d>& points_o, const std::vector<cv::Point2d>& normalised);

}  // namespace odograph::known_object
