// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <vector>

#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/scene.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Takes the events of a surface finder: keeps the surfaces in the scene and moves the anchors on them, under the lock
/// of the world. Not thread-safe.
class SurfaceUpdates {
 public:
  using Publish = std::function<void(const odo_header&)>;
  SurfaceUpdates(Scene& scene, Anchors& anchors, std::mutex& world_mutex)
      : scene_(scene), anchors_(anchors), mutex_(world_mutex) {}

  /// False if it concerns no surface that is kept. The message gets the ids of the session. `resets`: of the finder,
  /// which cannot withdraw what it found before; `publish` is called for that.
  bool take(odo_surface& message, uint32_t resets, const Publish& publish) {
    const uint32_t source = message.header.source;
    for (const Scene::Surface& orphan : take_orphans(source, resets)) {
      auto event = make_message<odo_surface>(ODO_TYPE_SURFACE, message.header.t_ns);
      event.header.source = source;
      event.id = orphan.id, event.kind = orphan.kind, event.state = ODO_SURFACE_WITHDRAWN;
      event.stride = sizeof(odo_vertex), event.offset = sizeof event, event.q_n[0] = 1;
      publish(event.header);
    }
    const std::lock_guard lock(mutex_);
    const Scene::Surface* kept = scene_.take(message, resets);
    if (!kept && message.merged_into != 0) kept = scene_.find(message.merged_into);
    if (kept)
      anchors_.follow_surface(message.id, kept->id, scene_.T_n_m() * kept->T_m_s, kept->sigma_m);
    else if (message.id != 0)
      anchors_.leave_surface(message.id);
    return message.id != 0;
  }

 private:
  std::vector<Scene::Surface> take_orphans(uint32_t source, uint32_t resets) {
    const std::lock_guard lock(mutex_);
    auto orphans = scene_.take_orphans(source, resets);
    for (const Scene::Surface& orphan : orphans) anchors_.leave_surface(orphan.id);
    return orphans;
  }

  Scene& scene_;
  Anchors& anchors_;
  std::mutex& mutex_;
};

}  // namespace odograph
