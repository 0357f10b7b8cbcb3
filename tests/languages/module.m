// SPDX-License-Identifier: Apache-2.0
// Swift's module map, compiled by clang: what it imports is there.
@import COdograph;

int32_t use(odo_session *session, const odo_pose *pose, odo_recording *recording) {
  uint64_t id = 0;
  const odo_anchor_place place = {sizeof place, ODO_ANCHOR_VIEW, ODO_TIME_LATEST};
  odo_recording_close(recording);
  return odo_anchor_create(session, &place, &id) + (int32_t)pose->state;
}
