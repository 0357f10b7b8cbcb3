/* SPDX-License-Identifier: Apache-2.0
 *
 * An attitude for the growth matrix, built with today's headers and, with ODO_TEST_GROWN, with those of a later
 * version. Its gyro_bias_b reports: the number of samples, the newest magnetometer's field of the later version, and
 * the size of the newest vendor's message. */
#include <stdlib.h>
#include <string.h>

#include <odograph/attitude.h>
#include <odograph/messages.h>

struct odo_instance {
  const odo_sink* sink;
  double samples, field, vendor_size;
};

static int32_t create(const odo_host* host, uint32_t number, const odo_string* kind, odo_instance** out) {
  (void)host, (void)number, (void)kind;
  *out = (odo_instance*)calloc(1, sizeof **out);
  return *out ? ODO_OK : ODO_E_MEMORY;
}

static int32_t configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  (void)self;
  if (count != 1 || stride < ODO_VALUE_SIZE_MIN || values->integer != 42) return ODO_E_CONFIG;
  return ODO_OK;
}

static int32_t activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  return ODO_OK;
}

static int32_t answer(odo_instance* self, const odo_header* sample) {
  odo_attitude attitude;
  memset(&attitude, 0, sizeof attitude);
  attitude.header.struct_size = sizeof attitude;
  attitude.header.type = ODO_TYPE_ATTITUDE;
  attitude.header.t_ns = sample->t_ns;
  attitude.q_n_b[1] = 1;
  attitude.covariance_n[0] = attitude.covariance_n[4] = attitude.covariance_n[8] = 1e-3;
  attitude.gyro_bias_b[0] = ++self->samples;
  attitude.gyro_bias_b[1] = self->field;
  attitude.gyro_bias_b[2] = self->vendor_size;
#ifdef ODO_TEST_GROWN
  attitude.grown[0] = 7;
#endif
  return self->sink->emit(self->sink, &attitude.header);
}

static int32_t process(odo_instance* self, const odo_batch* batch) {
  uint32_t i;
  for (i = 0; i < batch->count; ++i) {
    const odo_header* message = batch->messages[i];
    int32_t status = ODO_OK;
    if (message->type == ODO_TYPE_VENDOR(9, 1)) self->vendor_size = message->struct_size;
#ifdef ODO_TEST_GROWN
    if (message->type == ODO_TYPE_MAGNETOMETER) {
      const odo_magnetometer* field = (const odo_magnetometer*)(const void*)message;
      self->field = ODO_HAS(field, grown) ? field->grown[0] : -1;
    }
#endif
    if (message->type == ODO_TYPE_IMU) status = answer(self, message);
    if (status < 0) return status;
  }
  return ODO_OK;
}

static void destroy(odo_instance* self) { free(self); }

int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static const odo_string kind = {ODO_INTERFACE_ATTITUDE, sizeof ODO_INTERFACE_ATTITUDE - 1};
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(9, 1)};
  static odo_parameter row;
  odo_plugin table;
  uint32_t size;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  memset(&row, 0, sizeof row);
  row.struct_size = sizeof row, row.type = ODO_PARAMETER_INT, row.max = 100, row.count = 0;
  row.name.data = "answer", row.name.size = 6;
  row.help.data = "The answer.", row.help.size = 11;
  row.default_text.data = "42", row.default_text.size = 2;
  memset(&table, 0, sizeof table);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = &kind, table.interface_count = 1;
  table.id.data = "test/growth", table.id.size = 11;
  table.version.data = "1.0.0", table.version.size = 5;
  table.parameters = &row, table.parameter_count = 1, table.parameter_stride = sizeof row;
  table.inputs = inputs, table.input_count = 1;
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.destroy = destroy;
  size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
