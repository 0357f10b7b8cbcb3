/* SPDX-License-Identifier: Apache-2.0
 *
 * An app in C with the shared library, which contains hidden copies of the C++ runtime and yaml-cpp, and plugins that
 * throw exceptions of other runtimes from every call: none ends the app, and each is reported with its text.
 *   thrown_app PLUGIN_FOLDERS */
#include <stdio.h>
#include <string.h>

#include <odograph/odograph.h>

static int failures;
static char reported[1024];

static void expect(int holds, const char* id, const char* where, const char* what, const char* said) {
  if (holds) return;
  ++failures;
  fprintf(stderr, "%s throws %s in %s: found \"%s\"\n", id, what, where, said);
}

static void on_event(void* user, const odo_header* event) {
  const odo_report* report = (const odo_report*)(const void*)event;
  (void)user;
  if (event->type == ODO_TYPE_REPORT && strcmp(report->key, "exception") == 0)
    snprintf(reported, sizeof reported, "%s", report->text);
}

static void run(const char* folders, const char* id, const char* where, const char* what, const char* words) {
  char config[512];
  odo_session_options options;
  odo_error error;
  odo_session* session = NULL;
  odo_pose pose;
  int i;
  const int at_start = strcmp(where, "configure") == 0 || strcmp(where, "activate") == 0;
  snprintf(config, sizeof config,
           "odograph: 1\nattitude:\n  - plugin: attitude/vqf\n  - plugin: %s\n    parameters: {where: %s, what: %s}\n",
           id, where, what);
  memset(&options, 0, sizeof options), memset(&error, 0, sizeof error), memset(&pose, 0, sizeof pose);
  options.struct_size = sizeof options, options.run = ODO_RUN_REPLAY;
  options.config_text.data = config, options.config_text.size = strlen(config);
  options.plugin_path.data = folders, options.plugin_path.size = strlen(folders);
  error.struct_size = sizeof error;
  pose.header.struct_size = sizeof pose;
  reported[0] = 0;
  odo_session_create(&options, &session, &error);
  expect(at_start ? session == NULL : session != NULL, id, where, what, error.message);
  if (at_start) expect(strstr(error.message, words) != NULL, id, where, what, error.message);
  if (!session) return;
  odo_session_set_callback(session, NULL, ODO_ALL_EVENTS, on_event, NULL);
  for (i = 0; i < 300; ++i) {
    static const double gyro[3] = {0, 0, 0}, accel[3] = {0, 9.81, 0};
    odo_session_push_imu(session, 1000000000 + i * (int64_t)10000000, gyro, accel);
  }
  odo_session_flush(session);
  odo_session_save(session, NULL, 0);
  odo_session_flush(session);
  if (strcmp(where, "process") == 0) expect(strstr(reported, words) != NULL, id, where, what, reported);
  expect(odo_session_get_pose(session, ODO_TIME_LATEST, &pose) == ODO_OK, id, where, what, "no pose");
  odo_session_destroy(session);
}

/* The library's own yaml-cpp throws within it, with other copies of the runtime in the process. */
static void refused_text(void) {
  static const char text[] = "odograph: 1\nattitude: [a, b";
  odo_session_options options;
  odo_error error;
  odo_session* session = NULL;
  memset(&options, 0, sizeof options), memset(&error, 0, sizeof error);
  options.struct_size = sizeof options, error.struct_size = sizeof error;
  options.config_text.data = text, options.config_text.size = sizeof text - 1;
  expect(odo_session_create(&options, &session, &error) == ODO_E_CONFIG && !session, "the config", "parsing", "yaml",
         error.message);
}

int main(int argc, char** argv) {
  static const char* const ids[] = {"thrown/shared_runtime", "thrown/own_runtime"};
  static const char* const calls[] = {"configure", "activate", "process", "save", "destroy"};
  static const char* const whats[][2] = {
      {"yaml", "yaml-cpp"}, {"standard", "the shelf is empty"}, {"number", "exception"}};
  size_t i, k, w;
  if (argc < 2) return 2;
  for (i = 0; i < 2; ++i)
    for (k = 0; k < 5; ++k)
      for (w = 0; w < 3; ++w) run(argv[1], ids[i], calls[k], whats[w][0], whats[w][1]), refused_text();
  printf("30 exceptions out of plugins, %d surprises\n", failures);
  return failures ? 1 : 0;
}
