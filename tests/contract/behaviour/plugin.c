/* SPDX-License-Identifier: Apache-2.0
 *
 * An attitude for behaviour/app.c. It forges the host's bits in all its events; gyro_bias_b reports: the host's bits of
 * the newest sample, the result of emit within activate, and the largest batch size. */
#include <stdlib.h>
#include <string.h>

#include <odograph/attitude.h>
#include <odograph/messages.h>

struct odo_instance {
  const odo_sink* sink;
  double host_bits, early_status, count;
};

static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* kind, odo_instance** out) {
  (void)host, (void)number, (void)kind;
  *out = (odo_instance*)calloc(1, sizeof **out);
  return *out ? ODO_OK : ODO_E_MEMORY;
}

static int32_t ODO_CALL configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  (void)self, (void)values, (void)count, (void)stride;
  return ODO_OK;
}

static int32_t emit(odo_instance* self, int64_t t_ns) {
  odo_attitude attitude;
  memset(&attitude, 0, sizeof attitude);
  attitude.header.struct_size = sizeof attitude;
  attitude.header.type = ODO_TYPE_ATTITUDE;
  attitude.header.t_ns = t_ns;
  attitude.header.flags = ODO_FLAG_HOST_MASK | ODO_ATTITUDE_COVARIANCE | ODO_ATTITUDE_GYRO_BIAS;
  attitude.q_n_b[0] = 1;
  attitude.covariance_n[0] = attitude.covariance_n[4] = attitude.covariance_n[8] = 1e-3;
  attitude.gyro_bias_b[0] = self->host_bits;
  attitude.gyro_bias_b[1] = self->early_status;
  attitude.gyro_bias_b[2] = self->count;
  return self->sink->emit(self->sink, &attitude.header);
}

static int32_t ODO_CALL activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  self->early_status = emit(self, 0);
  return ODO_OK;
}

static int32_t ODO_CALL process(odo_instance* self, const odo_batch* batch) {
  uint32_t i;
  for (i = 0; i < batch->count; ++i) {
    const odo_header* message = batch->messages[i];
    if (message->type == ODO_TYPE_BAROMETER) self->host_bits = message->flags >> 24 & 0x7F;
    if (message->type == ODO_TYPE_IMU && emit(self, message->t_ns) < 0) return ODO_E_ERROR;
  }
  self->count += batch->count;
  return ODO_OK;
}

static void ODO_CALL destroy(odo_instance* self) { free(self); }

ODO_EXPORT int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static const odo_string kind = {ODO_INTERFACE_ATTITUDE, sizeof ODO_INTERFACE_ATTITUDE - 1};
  static const uint32_t inputs[] = {ODO_TYPE_BAROMETER};
  odo_plugin table;
  uint32_t size;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  memset(&table, 0, sizeof table);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = &kind, table.interface_count = 1;
  table.id.data = "test/behaviour", table.id.size = 14;
  table.version.data = "1.0.0", table.version.size = 5;
  table.summary.data = "For a test.", table.summary.size = 11;
  table.parameter_stride = sizeof(odo_parameter);
  table.inputs = inputs, table.input_count = 1;
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.destroy = destroy;
  size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
