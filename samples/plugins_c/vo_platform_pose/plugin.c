/* SPDX-License-Identifier: Apache-2.0
 *
 * vo/platform_pose: a front-end that converts the platform's own poses (ARKit, ARCore, OpenXR: odo_platform_pose) to
 * metric camera motion, so that the platform's tracking can replace any other odometry.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/messages.h>
#include <odograph/vo_frontend.h>

/* Camera pose in the platform's world at one result. */
struct view {
  int64_t t_ns;
  double q_w_c[4], p_w_c[3];
  uint32_t state, world;
};

struct odo_instance {
  const odo_sink* sink;
  /* parameters */
  double scale_sigma, position_walk, position_sigma, rotation_walk, rotation_sigma, frame_tolerance, max_gap, max_speed;
  /* state */
  uint32_t camera;
  int has_camera, has_last, has_tracked, has_frame, has_pose;
  double q_b_c[4], p_b_c[3];
  struct view last;       /* of the last result */
  int64_t frame_ns;       /* newest frame, still without a motion */
  odo_platform_pose pose; /* newest pose, not used for a motion yet */
  int frames_seen;
  uint32_t scale_group;
};

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }
#define REAL(name, unit, help, text, min, max)                                                                         \
  {                                                                                                                    \
    sizeof(odo_parameter), ODO_PARAMETER_REAL, TEXT(name), TEXT(unit), TEXT(help), TEXT(text), {NULL, 0}, min, max, 1, \
        0                                                                                                              \
  }

static const odo_parameter parameters[] = {
    REAL("scale_sigma", "", "Relative standard deviation of the platform's scale; assumed: measure it on your devices.",
         "0.02", 0.0001, 1.0),
    REAL("position_walk", "m^(1/2)",
         "Standard deviation of the position after 1 m, in addition to the scale's; assumed.", "0.01", 0.0, 1.0),
    REAL("position_sigma", "m", "Standard deviation of one position relative to its neighbours; assumed.", "0.002",
         0.000001, 1.0),
    REAL("rotation_walk", "rad/s^(1/2)", "Standard deviation of the rotation after 1 s; assumed.", "0.001", 0.0, 1.0),
    REAL("rotation_sigma", "rad", "Standard deviation of one rotation relative to its neighbours; assumed.", "0.0005",
         0.000001, 1.0),
    REAL("frame_tolerance", "s", "Largest time difference between a pose and its frame; a quarter of a frame at 60 Hz.",
         "0.004", 0.0, 0.1),
    REAL("max_gap", "s", "Longest interval of two poses for a translation; ARKit relocalises after interruptions.", "1",
         0.01, 60.0),
    REAL("max_speed", "m/s", "Speed above which a translation is a relocalisation; sprinters reach 12 m/s.", "15", 0.1,
         1000.0)};
static const size_t members[] = {
    offsetof(struct odo_instance, scale_sigma),    offsetof(struct odo_instance, position_walk),
    offsetof(struct odo_instance, position_sigma), offsetof(struct odo_instance, rotation_walk),
    offsetof(struct odo_instance, rotation_sigma), offsetof(struct odo_instance, frame_tolerance),
    offsetof(struct odo_instance, max_gap),        offsetof(struct odo_instance, max_speed)};
#define PARAMETERS (sizeof parameters / sizeof *parameters)

static const odo_string kind = TEXT(ODO_INTERFACE_VO_FRONTEND);

static int same(const odo_string* a, const odo_string* b) {
  return a->size == b->size && memcmp(a->data, b->data, (size_t)a->size) == 0;
}

static int32_t ODO_CALL reset(odo_instance* self) {
  self->has_camera = self->has_last = self->has_tracked = self->has_frame = self->has_pose = self->frames_seen = 0;
  memset(self->q_b_c, 0, sizeof self->q_b_c);
  memset(self->p_b_c, 0, sizeof self->p_b_c);
  self->q_b_c[0] = 1;
  self->camera = self->scale_group = 0;
  return ODO_OK;
}

static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* wanted, odo_instance** out) {
  (void)host, (void)number;
  if (!out || !wanted || !same(wanted, &kind)) return ODO_E_UNSUPPORTED;
  *out = (odo_instance*)calloc(1, sizeof **out);
  return *out ? reset(*out) : ODO_E_MEMORY;
}

/* The host passes a value for each row of the table. */
static int32_t ODO_CALL configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  for (uint32_t i = 0; i < count; ++i) { /* rows of a newer host are larger */
    const odo_value* value = (const odo_value*)(const void*)((const char*)values + (size_t)i * stride);
    for (uint32_t k = 0; k < PARAMETERS; ++k)
      if (same(&value->name, &parameters[k].name)) *(double*)(void*)((char*)self + members[k]) = value->reals[0];
  }
  return ODO_OK;
}

static int32_t ODO_CALL activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  return ODO_OK;
}

static void multiply(const double* a, const double* b, double* out) {
  out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

static void conjugate(const double* q, double* out) { out[0] = q[0], out[1] = -q[1], out[2] = -q[2], out[3] = -q[3]; }

static void rotate(const double* q, const double* v, double* out) {
  const double pure[4] = {0, v[0], v[1], v[2]};
  double inverse[4], half[4], whole[4];
  conjugate(q, inverse);
  multiply(q, pure, half);
  multiply(half, inverse, whole);
  out[0] = whole[1], out[1] = whole[2], out[2] = whole[3];
}

static int within(const double* x, int n, double bound) { /* false for NaN too */
  int i;
  for (i = 0; i < n; ++i)
    if (!(fabs(x[i]) <= bound)) return 0;
  return 1;
}

static int is_unit(const double* q) { return fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 0.01; }

/* Difference of any two times, without overflow. */
static double seconds(int64_t later_ns, int64_t earlier_ns) {
  return 1e-9 * (double)(int64_t)((uint64_t)later_ns - (uint64_t)earlier_ns);
}

/* Camera pose at t_ns: the platform's own, or the body pose with the camera's mount. */
static struct view view_of(const odo_instance* self, const odo_platform_pose* pose, int64_t t_ns) {
  struct view view;
  double norm, lever_w[3];
  view.t_ns = t_ns, view.world = pose->world;
  view.state = pose->state == ODO_TRACKING || pose->state == ODO_DEGRADED ? pose->state : ODO_LOST;
  memcpy(view.q_w_c, pose->q_w, sizeof view.q_w_c);
  memcpy(view.p_w_c, pose->p_w, sizeof view.p_w_c);
  if (!(pose->header.flags & ODO_PLATFORM_POSE_CAMERA)) {
    multiply(pose->q_w, self->q_b_c, view.q_w_c);
    rotate(pose->q_w, self->p_b_c, lever_w);
    for (int i = 0; i < 3; ++i) view.p_w_c[i] += lever_w[i];
  }
  norm = sqrt(view.q_w_c[0] * view.q_w_c[0] + view.q_w_c[1] * view.q_w_c[1] + view.q_w_c[2] * view.q_w_c[2] +
              view.q_w_c[3] * view.q_w_c[3]);
  for (int i = 0; i < 4; ++i) view.q_w_c[i] /= norm; /* platforms provide floats */
  return view;
}

/* q_c0_c1 = q_w_c0^-1 q_w_c1, p_c0_c1 = q_w_c0^-1 (p_w_c1 - p_w_c0) */
static void fill_motion(const odo_instance* self, const struct view* to, odo_vo_motion* motion) {
  const struct view* from = &self->last;
  const double dt = seconds(to->t_ns, from->t_ns),
               d[3] = {to->p_w_c[0] - from->p_w_c[0], to->p_w_c[1] - from->p_w_c[1], to->p_w_c[2] - from->p_w_c[2]};
  const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  double inverse[4];
  if (to->world != from->world || to->state == ODO_LOST || from->state == ODO_LOST) return;
  conjugate(from->q_w_c, inverse);
  multiply(inverse, to->q_w_c, motion->q_c0_c1);
  for (int i = 0; i < 3; ++i)
    motion->covariance[7 * i] =
        2 * self->rotation_sigma * self->rotation_sigma + self->rotation_walk * self->rotation_walk * dt;
  motion->header.flags |= ODO_VO_ROTATION | ODO_VO_COVARIANCE;
  /* While tracking is limited, the platform provides the orientation by the gyroscope but no position. */
  if (to->state != ODO_TRACKING || from->state != ODO_TRACKING || dt > self->max_gap || length > self->max_speed * dt)
    return;
  rotate(inverse, d, motion->p_c0_c1);
  for (int i = 3; i < 6; ++i)
    motion->covariance[7 * i] =
        2 * self->position_sigma * self->position_sigma + self->position_walk * self->position_walk * length;
  motion->header.flags |= ODO_VO_TRANSLATION;
}

static int32_t emit_motion(odo_instance* self, const odo_platform_pose* pose, int64_t t_ns) {
  const struct view view = view_of(self, pose, t_ns);
  odo_vo_motion motion;
  if (!self->has_last) {
    self->has_last = 1, self->last = view;
    self->has_tracked = view.state == ODO_TRACKING;
    return ODO_NOT_READY;
  }
  memset(&motion, 0, sizeof motion);
  motion.header.struct_size = sizeof motion;
  motion.header.type = ODO_TYPE_VO_MOTION;
  motion.header.t_ns = t_ns;
  motion.header.flags = ODO_VO_METRIC;
  motion.t_from_ns = self->last.t_ns;
  motion.q_c0_c1[0] = 1;
  motion.camera = pose->header.flags & ODO_PLATFORM_POSE_CAMERA ? pose->header.source : self->camera;
  motion.scale_sigma = self->scale_sigma;
  if (view.world != self->last.world) ++self->scale_group;
  motion.scale_group = self->scale_group;
  fill_motion(self, &view, &motion);
  motion.state = motion.header.flags & ODO_VO_TRANSLATION ? ODO_TRACKING
                 : view.state == ODO_LOST                 ? ODO_LOST
                                                          : ODO_DEGRADED;
  self->has_tracked = self->has_tracked || view.state == ODO_TRACKING;
  /* The message has no reason: before the first good pose and in a new world the platform is initialising; later it
   * mostly
   * lacks features. */
  if (motion.state != ODO_TRACKING)
    motion.reason =
        self->has_tracked && view.world == self->last.world ? ODO_REASON_FEW_FEATURES : ODO_REASON_INITIALISING;
  self->last = view;
  return self->sink->emit(self->sink, &motion.header);
}

/* With frames, a pose belongs to the frame of its time; without, each pose is a frame. */
static int32_t match(odo_instance* self) {
  if (!self->has_pose) return ODO_NOT_READY;
  if (!self->frames_seen) {
    self->has_pose = 0;
    return emit_motion(self, &self->pose, self->pose.header.t_ns);
  }
  if (!self->has_frame || fabs(seconds(self->pose.header.t_ns, self->frame_ns)) > self->frame_tolerance)
    return ODO_NOT_READY;
  if (self->has_last && self->frame_ns <= self->last.t_ns) return ODO_NOT_READY;
  self->has_pose = self->has_frame = 0;
  return emit_motion(self, &self->pose, self->frame_ns);
}

static int32_t on_frame(odo_instance* self, const odo_header* frame) {
  if (self->frames_seen && frame->t_ns <= self->frame_ns) return ODO_E_DISCARD;
  self->frames_seen = self->has_frame = 1;
  self->frame_ns = frame->t_ns;
  if (!self->has_camera) self->camera = frame->source;
  return match(self);
}

static int32_t on_pose(odo_instance* self, const odo_platform_pose* pose) {
  if (self->has_last && pose->header.t_ns < self->last.t_ns &&
      seconds(self->last.t_ns, pose->header.t_ns) > self->frame_tolerance)
    return ODO_E_DISCARD;
  if (!self->frames_seen && self->has_last && pose->header.t_ns <= self->last.t_ns) return ODO_E_DISCARD;
  if (!is_unit(pose->q_w) || !within(pose->p_w, 3, 1e7)) return ODO_E_DISCARD;
  self->pose = *pose;
  self->has_pose = 1;
  return match(self);
}

static int32_t on_calibration(odo_instance* self, const odo_calibration* calibration) {
  if (self->has_camera && calibration->header.source != self->camera) return ODO_OK;
  self->has_camera = 1, self->camera = calibration->header.source;
  if (!(calibration->header.flags & ODO_CALIBRATION_EXTRINSICS)) return ODO_OK;
  if (!is_unit(calibration->q_b_c) || !within(calibration->p_b_c, 3, 100)) return ODO_E_DISCARD;
  memcpy(self->q_b_c, calibration->q_b_c, sizeof self->q_b_c);
  memcpy(self->p_b_c, calibration->p_b_c, sizeof self->p_b_c);
  return ODO_OK;
}

static int32_t ODO_CALL process(odo_instance* self, const odo_batch* batch) {
  int32_t worst = ODO_OK;
  for (uint32_t i = 0; i < batch->count; ++i) {
    const odo_header* message = batch->messages[i];
    int32_t status = ODO_OK;
    odo_platform_pose pose;
    odo_calibration calibration;
    switch (message->type) {
      case ODO_TYPE_FRAME: status = on_frame(self, message); break;
      case ODO_TYPE_PLATFORM_POSE: /* smaller from an older host, larger from a newer one */
        odo_copy(&pose, sizeof pose, message);
        status = on_pose(self, &pose);
        break;
      case ODO_TYPE_CALIBRATION:
        odo_copy(&calibration, sizeof calibration, message);
        status = on_calibration(self, &calibration);
        break;
      default: break;
    }
    if (status < worst) worst = status;
  }
  return worst;
}

static void ODO_CALL destroy(odo_instance* self) { free(self); }

int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static const odo_string id = TEXT("vo/platform_pose"), version = TEXT("1.0.0");
  static const odo_string summary = TEXT("The platform's own poses (ARKit, ARCore) as metric camera motion");
  static const odo_string refusal = TEXT("this plugin needs another version of the ABI than the host's");
  static const uint32_t inputs[] = {ODO_TYPE_PLATFORM_POSE};
  odo_plugin table;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  if (!ODO_HOST_FITS(host)) {
    out->refusal = refusal;
    return ODO_E_VERSION;
  }
  memset(&table, 0, sizeof table);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = &kind, table.interface_count = 1;
  table.id = id, table.version = version, table.summary = summary;
  table.parameters = parameters, table.parameter_count = PARAMETERS, table.parameter_stride = sizeof(odo_parameter);
  table.inputs = inputs, table.input_count = sizeof inputs / sizeof *inputs;
  table.flags = ODO_PLUGIN_NATIVE_FRAMES; /* it uses the frame times only */
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.reset = reset, table.destroy = destroy;
  /* A host of another version has a smaller or a larger table. */
  const uint32_t size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
