/* SPDX-License-Identifier: Apache-2.0
 *
 * fix/range: an absolute fixer from distances to transmitters at known positions. Glue between the ABI and range_fix.h.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/absolute_fixer.h>
#include <odograph/messages.h>

#include "range_fix.h"

struct odo_instance {
  const odo_sink* sink;
  uint32_t camera; /* whose mount is used: the first camera with a calibration */
  int has_camera;
  double q_b_c[4], p_b_c[3];
  range_fix fix;
};

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }
#define REAL(name, unit, help, text, min, max)                                                                         \
  {                                                                                                                    \
    sizeof(odo_parameter), ODO_PARAMETER_REAL, TEXT(name), TEXT(unit), TEXT(help), TEXT(text), {NULL, 0}, min, max, 1, \
        0                                                                                                              \
  }
#define INTEGER(name, help, text, min, max) \
  { sizeof(odo_parameter), ODO_PARAMETER_INT, TEXT(name), {NULL, 0}, TEXT(help), TEXT(text), {NULL, 0}, min, max, 1, 0 }

static const odo_parameter parameters[] = {
    REAL("interval", "s", "Time span of the ranges of one fix; two to five ranges per transmitter at 10 Hz.", "0.5",
         0.05, 10.0),
    REAL("max_gap", "s",
         "Longest interval between two poses to interpolate at a range; a slow walker's step takes 1 s.", "1.5", 0.05,
         10.0),
    REAL("bias_sigma", "m",
         "Error of a transmitter's ranges that does not average out (multipath, antenna delay); assumed.", "0.05", 0.0,
         10.0),
    REAL("correlation", "s", "Correlation time of that error: that of walking a few metres; assumed.", "2", 0.0, 100.0),
    REAL("prior_sigma", "m",
         "Standard deviation of a pose without covariance, and limit for a direction determined by ranges.", "10", 0.01,
         1000.0),
    REAL("unobserved_sigma", "m", "Standard deviation in directions without ranges: large compared with any session.",
         "1000", 10.0, 100000.0),
    REAL("gate", "", "Normalised innovation above which a range is rejected; 3.5 sigma is one in 2000 good ranges.",
         "3.5", 1.0, 100.0),
    INTEGER("max_rejected", "Consecutive windows with most ranges rejected after which the ranges are trusted; 5 s.",
            "10", 1, 1000)};

/* Offset of each row's value, in the order of the table. */
static const size_t reals[] = {
    offsetof(range_parameters, interval_s),    offsetof(range_parameters, max_gap_s),
    offsetof(range_parameters, bias_sigma_m),  offsetof(range_parameters, correlation_s),
    offsetof(range_parameters, prior_sigma_m), offsetof(range_parameters, unobserved_sigma_m),
    offsetof(range_parameters, gate)};
#define PARAMETERS (sizeof parameters / sizeof *parameters)
#define REALS (sizeof reals / sizeof *reals)

static const odo_string kind = TEXT(ODO_INTERFACE_ABSOLUTE_FIXER);

static int same(const odo_string* a, const odo_string* b) {
  return a->size == b->size && memcmp(a->data, b->data, (size_t)a->size) == 0;
}

static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* wanted, odo_instance** out) {
  (void)host, (void)number;
  if (!out || !wanted || !same(wanted, &kind)) return ODO_E_UNSUPPORTED;
  *out = (odo_instance*)calloc(1, sizeof **out);
  if (!*out) return ODO_E_MEMORY;
  (*out)->q_b_c[0] = 1;
  return ODO_OK;
}

/* The host passes a value for each row of the table. */
static int32_t ODO_CALL configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  for (uint32_t i = 0; i < count; ++i) { /* rows of a newer host are larger */
    const odo_value* value = (const odo_value*)(const void*)((const char*)values + (size_t)i * stride);
    for (uint32_t k = 0; k < PARAMETERS; ++k) {
      if (!same(&value->name, &parameters[k].name)) continue;
      if (k < REALS)
        *(double*)(void*)((char*)&self->fix.parameters + reals[k]) = value->reals[0];
      else
        self->fix.parameters.max_rejected = value->integer;
    }
  }
  return ODO_OK;
}

static int32_t ODO_CALL activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  return ODO_OK;
}

static int within(const double* x, int n, double bound) { /* false for NaN too */
  int i;
  for (i = 0; i < n; ++i)
    if (!(fabs(x[i]) <= bound)) return 0;
  return 1;
}

static int is_unit(const double* q) { return fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 0.01; }

static int32_t on_calibration(odo_instance* self, const odo_calibration* calibration) {
  if (self->has_camera && calibration->header.source != self->camera) return ODO_OK;
  if (!(calibration->header.flags & ODO_CALIBRATION_EXTRINSICS)) return ODO_OK;
  if (!is_unit(calibration->q_b_c) || !within(calibration->p_b_c, 3, 100)) return ODO_E_DISCARD;
  self->has_camera = 1, self->camera = calibration->header.source;
  memcpy(self->q_b_c, calibration->q_b_c, sizeof self->q_b_c);
  memcpy(self->p_b_c, calibration->p_b_c, sizeof self->p_b_c);
  return ODO_OK;
}

/* Converts the pose to one of the body. */
static int32_t on_pose(odo_instance* self, const odo_pose* pose) {
  const uint32_t needed = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC;
  const double prior2 = self->fix.parameters.prior_sigma_m * self->fix.parameters.prior_sigma_m;
  range_pose body;
  if ((pose->header.flags & needed) != needed || pose->state == ODO_LOST) return ODO_NOT_READY;
  if (!is_unit(pose->q_n) || !within(pose->p_n, 3, 1e7)) return ODO_E_DISCARD;
  memset(&body, 0, sizeof body);
  body.t_ns = pose->header.t_ns;
  memcpy(body.q_n_b, pose->q_n, sizeof body.q_n_b);
  memcpy(body.p_n, pose->p_n, sizeof body.p_n);
  for (int i = 0; i < 3; ++i) body.covariance_n[4 * i] = prior2;
  if ((pose->header.flags & ODO_POSE_COVARIANCE) && within(pose->covariance, 36, 1e12)) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) body.covariance_n[3 * i + k] = pose->covariance[6 * (3 + i) + 3 + k];
    body.yaw_variance = pose->covariance[14] > 0 ? pose->covariance[14] : 0;
  }
  if (pose->header.flags & ODO_POSE_CAMERA) {
    const double inverse[4] = {self->q_b_c[0], -self->q_b_c[1], -self->q_b_c[2], -self->q_b_c[3]};
    double lever_n[3];
    range_multiply(body.q_n_b, inverse, body.q_n_b);
    range_rotate(body.q_n_b, self->p_b_c, lever_n);
    for (int i = 0; i < 3; ++i) body.p_n[i] -= lever_n[i];
  }
  range_fix_add_pose(&self->fix, &body);
  return ODO_OK;
}

static int32_t on_range(odo_instance* self, const odo_range* range) {
  range_sample sample;
  range_result result;
  odo_fix event;
  if (!(range->header.flags & ODO_RANGE_TRANSMITTER)) return ODO_NOT_READY;
  if (!(range->range_m > 0 && range->range_m < 1e6 && range->sigma_m > 0 && range->sigma_m < 1e6 &&
        range->transmitter_sigma_m >= 0 && range->transmitter_sigma_m < 1e6) ||
      !within(range->p_n, 3, 1e7) || !within(range->lever_b, 3, 100))
    return ODO_E_DISCARD;
  memset(&sample, 0, sizeof sample);
  sample.t_ns = range->header.t_ns;
  sample.transmitter = range->transmitter;
  sample.range_m = range->range_m, sample.sigma_m = range->sigma_m;
  sample.transmitter_sigma_m = range->transmitter_sigma_m;
  memcpy(sample.transmitter_n, range->p_n, sizeof sample.transmitter_n);
  if (range->header.flags & ODO_RANGE_LEVER) memcpy(sample.lever_b, range->lever_b, sizeof sample.lever_b);
  if (!range_fix_add_range(&self->fix, &sample, &result)) return ODO_NOT_READY;
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_FIX;
  event.header.t_ns = result.t_ns;
  event.header.flags =
      ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_LEVER | ODO_FLAG_QUALITY;
  event.header.quality = (float)result.used / (float)result.given;
  memcpy(event.p_n, result.p_n, sizeof event.p_n);
  memcpy(event.covariance_n, result.covariance_n, sizeof event.covariance_n);
  memcpy(event.lever_b, result.lever_b, sizeof event.lever_b);
  return self->sink->emit(self->sink, &event.header);
}

static int32_t on_correction(odo_instance* self, const odo_correction* correction) {
  if (!is_unit(correction->q_n) || !within(correction->p_n, 3, 1e7)) return ODO_E_DISCARD;
  range_fix_correct(&self->fix, correction->q_n, correction->p_n);
  return ODO_OK;
}

static int32_t on_message(odo_instance* self, const odo_header* message) {
  union {
    odo_calibration calibration;
    odo_pose pose;
    odo_range range;
    odo_correction correction;
  } mine; /* the message of an older host is smaller */
  odo_copy(&mine, sizeof mine, message);
  switch (message->type) {
    case ODO_TYPE_CALIBRATION: return on_calibration(self, &mine.calibration);
    case ODO_TYPE_POSE: return on_pose(self, &mine.pose);
    case ODO_TYPE_RANGE: return on_range(self, &mine.range);
    case ODO_TYPE_CORRECTION: return on_correction(self, &mine.correction);
    default: return ODO_OK;
  }
}

static int32_t ODO_CALL process(odo_instance* self, const odo_batch* batch) {
  int32_t worst = ODO_OK;
  for (uint32_t i = 0; i < batch->count; ++i) {
    const int32_t status = on_message(self, batch->messages[i]);
    if (status < worst) worst = status;
  }
  return worst;
}

static int32_t ODO_CALL reset(odo_instance* self) {
  const double none[4] = {1, 0, 0, 0};
  range_fix_clear(&self->fix);
  memcpy(self->q_b_c, none, sizeof none);
  memset(self->p_b_c, 0, sizeof self->p_b_c);
  self->has_camera = 0;
  return ODO_OK;
}

static void ODO_CALL destroy(odo_instance* self) { free(self); }

int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static const odo_string id = TEXT("fix/range"), version = TEXT("1.0.0");
  static const odo_string summary = TEXT("Position from distances to transmitters at known positions");
  static const odo_string refusal = TEXT("this plugin needs another version of the ABI than the host's");
  static const uint32_t inputs[] = {ODO_TYPE_CORRECTION};
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
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.reset = reset, table.destroy = destroy;
  /* A host of another version has a smaller or a larger table. */
  const uint32_t size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
