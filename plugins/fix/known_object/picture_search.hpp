// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/features2d.hpp>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// Finds pictures of known objects in a frame: SIFT (Lowe, IJCV 60, 2004) of the picture as it looks from in front and
/// from aside (after ASIFT: Morel & Yu, SIAM J. Imaging Sci. 2, 2009), a homography by RANSAC, and the two poses of a
/// plane that explain it (IPPE: Collins & Bartoli, IJCV 109, 2014). One thread at a time.
class PictureSearch {
 public:
  struct Parameters {
    int frame_features = 1200, picture_features = 350;  ///< of the frame; of each view of a picture
    double longest_px = 512;                            ///< pictures are brought to this
    double ratio = 0.8;         ///< of the distances to the best and to the second-best other place (Lowe)
    double inlier_px = 3;       ///< of the homography
    int min_inliers = 7;        ///< judgement; alignment decides in the end
    size_t max_places = 3;      ///< looked for of one picture in one frame
    double contrast = 0.02;     ///< of SIFT, half of Lowe's: small and dim pictures
    float other_place = 0.05F;  ///< of the object's longer side: nearer, two features are of one place; judgement
  };
  PictureSearch(const Parameters& parameters, const std::vector<PlaneObject>& objects);

  /// What one frame shows, once for all objects.
  struct Features {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    std::vector<cv::Point2d> normalised;
  };
  Features look(const cv::Mat& grey, const cv::Mat& mask, const CameraModel& camera) const;

  /// Where an object may be: for each place in the frame up to two poses.
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

/// The poses of a plane whose points (in o, z = 0) are seen at normalised coordinates, the better one first; empty
/// where there is none in front of the camera.
std::vector<Pose> plane_poses(const std::vector<cv::Point3d>& points_o, const std::vector<cv::Point2d>& normalised);

}  // namespace odograph::known_object
