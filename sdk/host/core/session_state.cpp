// SPDX-License-Identifier: Apache-2.0
//
// What an app asks of a session between samples: the pose of body or camera, saved state and geodetic coordinates.
#include <algorithm>
#include <cstring>

#include "sdk/host/base/pose_frame.hpp"
#include "sdk/host/core/session.hpp"

namespace odograph {

int32_t Session::pose_of(uint32_t of, bool smooth, int64_t t_ns, odo_pose& out) const {
  if (of > ODO_OF_CAMERA) return ODO_E_ARGUMENT;
  const int32_t status = poses_.at(t_ns, smooth, out);
  const bool is_camera = (out.header.flags & ODO_POSE_CAMERA) != 0;
  if (status != ODO_OK || of == ODO_OF_PIPELINE || is_camera == (of == ODO_OF_CAMERA)) return status;
  Camera mount;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = cameras_.find(pipeline_->camera()); found != cameras_.end()) mount = found->second;
  }
  if (is_camera)
    move_pose(mount.q_b_c.conjugate(), -(mount.q_b_c.conjugate() * mount.p_b_c), out);
  else
    move_pose(mount.q_b_c, mount.p_b_c, out);
  out.header.flags ^= ODO_POSE_CAMERA;
  return status;
}

int64_t Session::save(void* data, uint64_t capacity) {
  Lock lock(mutex_);
  if (is_owner()) return ODO_E_STATE;
  const Ownership ownership(*this, lock);
  lock.unlock();
  const auto blob = pipeline_->save();
  if (data && blob.size() <= capacity) std::memcpy(data, blob.data(), blob.size());
  return static_cast<int64_t>(blob.size());
}

int32_t Session::load(const void* data, uint64_t size) {
  Lock lock(mutex_);
  if (is_owner()) return ODO_E_STATE;
  const Ownership ownership(*this, lock);
  lock.unlock();
  const auto loaded = pipeline_->load({static_cast<const uint8_t*>(data), static_cast<size_t>(size)});
  if (loaded) return ODO_OK;
  host_.report(0, ODO_SEVERITY_WARNING, "load", loaded.failure().text);
  return loaded.failure().status;
}

int32_t Session::to_geodetic(const double* p_n, double* geodetic) const {
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto g = geodesy_.to_geodetic({p_n[0], p_n[1], p_n[2]});
  std::copy(g.begin(), g.end(), geodetic);
  return ODO_OK;
}

int32_t Session::from_geodetic(const double* geodetic, double* p_n) const {
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto p = geodesy_.from_geodetic({geodetic[0], geodetic[1], geodetic[2]});
  std::copy(p.begin(), p.end(), p_n);
  return ODO_OK;
}

}  // namespace odograph
