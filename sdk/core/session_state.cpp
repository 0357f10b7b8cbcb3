// SPDX-License-Identifier: Apache-2.0
//
// What an app asks of a session between samples: saved state and geodetic coordinates.
#include <algorithm>
#include <cstring>

#include "sdk/core/session.hpp"

namespace odograph {

int64_t Session::save(void* data, uint64_t capacity) {
  Lock lock(mutex_);
  if (has_turn()) return ODO_E_STATE;
  const Turn turn(*this, lock);
  lock.unlock();
  const auto blob = pipeline_->save();
  if (data && blob.size() <= capacity) std::memcpy(data, blob.data(), blob.size());
  return static_cast<int64_t>(blob.size());
}

int32_t Session::load(const void* data, uint64_t size) {
  Lock lock(mutex_);
  if (has_turn()) return ODO_E_STATE;
  const Turn turn(*this, lock);
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
