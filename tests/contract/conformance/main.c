/* SPDX-License-Identifier: Apache-2.0
 *
 * odograph-host-conformance LIBODOGRAPH [PLUGIN_FOLDER]: checks a library against the public headers. */
#include "suite.h"

static conformance_case *first_case, **last_case = &first_case;

void add_case(conformance_case* added) { *last_case = added, last_case = &added->next; }

typedef struct command {
  const char *library, *only;
  bool list, json, help;
  double limit_s;
} command;

static const char help[] =
    "odograph-host-conformance LIBODOGRAPH [PLUGIN_FOLDER]\n"
    "\n"
    "Checks a host library of Odograph against the sentences of the public headers. Each case runs in a process of "
    "its\n"
    "own. The suite registers its plugins; with PLUGIN_FOLDER it loads them from there where the library has no\n"
    "odo_register_plugin.\n"
    "\n"
    "  --list           the cases, and the sentences that they check; needs no library\n"
    "  --only PATTERN   cases whose name has PATTERN within\n"
    "  --json           one object for a machine\n"
    "  --from-folder    load the plugins from PLUGIN_FOLDER in any case\n"
    "  --limit SECONDS  longest time of a case (20)\n"
    "  --help           this text\n"
    "\n"
    "Exit status: 0 no case failed, 1 some did, 2 bad usage, a library that cannot be loaded or of another ABI.\n";

static int bad_usage(const char* what, const char* detail) {
  fprintf(stderr, "odograph-host-conformance: %s%s; --help lists the options\n", what, detail);
  return 2;
}

/* 0, or the exit status. */
static int read_command(int argc, char** argv, command* out) {
  for (int i = 1; i < argc; ++i) {
    const char* word = argv[i];
    const bool takes_value = strcmp(word, "--only") == 0 || strcmp(word, "--limit") == 0;
    if (takes_value && i + 1 == argc) return bad_usage("a value is missing behind ", word);
    if (strcmp(word, "--list") == 0)
      out->list = true;
    else if (strcmp(word, "--json") == 0)
      out->json = true;
    else if (strcmp(word, "--help") == 0)
      out->help = true;
    else if (strcmp(word, "--from-folder") == 0)
      options.by_folder = true;
    else if (strcmp(word, "--only") == 0)
      out->only = argv[++i];
    else if (strcmp(word, "--limit") == 0)
      out->limit_s = atof(argv[++i]);
    else if (word[0] == '-')
      return bad_usage("unknown option ", word);
    else if (!out->library)
      out->library = word;
    else if (!options.plugin_folder)
      options.plugin_folder = word;
    else
      return bad_usage("too many arguments: ", word);
  }
  if (!out->library && !out->list && !out->help) return bad_usage("which library?", "");
  if (options.by_folder && !options.plugin_folder) return bad_usage("--from-folder needs PLUGIN_FOLDER", "");
  return out->limit_s > 0 ? 0 : bad_usage("--limit needs a number above 0", "");
}

static void print_json_text(const char* text) {
  putchar('"');
  for (; *text; ++text) {
    if (*text == '"' || *text == '\\') putchar('\\');
    if (*text == '\n')
      fputs("\\n", stdout);
    else if ((unsigned char)*text < 32)
      printf("\\u%04x", (unsigned char)*text);
    else
      putchar(*text);
  }
  putchar('"');
}

static void print_field(const char* name, const char* text, const char* after) {
  printf("\"%s\": ", name);
  print_json_text(text);
  fputs(after, stdout);
}

static const char* const outcome_names[] = {"pass", "fail", "skip"};

static void print_json_case(const conformance_case* of, const result* found, bool first) {
  fputs(first ? "\n    {" : ",\n    {", stdout);
  print_field("name", of->name, ", ");
  print_field("header", of->header, ", ");
  print_field("sentence", of->sentence, found ? ", " : "}");
  if (!found) return;
  print_field("result", outcome_names[found->outcome], ", ");
  printf("\"seconds\": %.3f, ", found->seconds);
  print_field("text", found->text, "}");
}

static void print_lines(const char* text) {
  while (*text) {
    const size_t size = strcspn(text, "\n");
    printf("        %.*s\n", (int)size, text);
    text += size + (text[size] == '\n');
  }
}

static void print_case(const conformance_case* of, const result* found) {
  if (!found) {
    printf("%s\n    %s: %s\n", of->name, of->header, of->sentence);
    return;
  }
  if (found->outcome == SKIPPED) {
    printf("skip  %s: %s", of->name, found->text);
    return;
  }
  printf("%s  %s\n", outcome_names[found->outcome], of->name);
  if (found->outcome == FAILED) printf("      odograph/%s: \"%s\"\n", of->header, of->sentence);
  print_lines(found->text);
  if (found->lines > MAX_LINES) printf("        and %u more\n", found->lines - MAX_LINES);
  fflush(stdout);
}

/* Runs or lists the selected cases. */
static void go_through(const command* chosen, unsigned counts[3]) {
  bool first = true;
  for (const conformance_case* of = first_case; of; of = of->next) {
    result found;
    if (chosen->only && !strstr(of->name, chosen->only)) continue;
    if (!chosen->list) {
      run_case(of, chosen->limit_s, chosen->json, &found);
      ++counts[found.outcome];
    }
    if (chosen->json)
      print_json_case(of, chosen->list ? NULL : &found, first);
    else
      print_case(of, chosen->list ? NULL : &found);
    first = false;
  }
}

/* 0, or the exit status if the library cannot be tested. */
static int check_library(const char* path) {
  const char* why = library_open(path);
  if (why) {
    fprintf(stderr, "odograph-host-conformance: %s: %s\n", path, why);
    return 2;
  }
  uint32_t abi = odo.abi_version();
  if (abi >> 16 == ODO_ABI_MAJOR) return 0;
  fprintf(
      stderr,
      "odograph-host-conformance: %s (version %s) has ABI %u.%u; this suite checks ABI %u.%u, whose messages differ: "
      "no case was run\n",
      path, odo.version(), abi >> 16, abi & 0xFFFF, ODO_ABI_MAJOR, ODO_ABI_MINOR);
  return 2;
}

int main(int argc, char** argv) {
  command chosen = {NULL, NULL, false, false, false, 20};
  unsigned counts[3] = {0, 0, 0};
  int status = read_command(argc, argv, &chosen);
  if (status != 0) return status;
  if (chosen.help) return fputs(help, stdout), 0;
  if (!chosen.list) status = check_library(chosen.library);
  if (status != 0) return status;
  if (chosen.json) {
    printf("{\n  ");
    print_field("library", chosen.library ? chosen.library : "", ",\n  \"cases\": [");
  }
  go_through(&chosen, counts);
  if (chosen.json) {
    printf("\n  ],\n  \"passed\": %u, \"failed\": %u, \"skipped\": %u\n}\n", counts[PASSED], counts[FAILED],
           counts[SKIPPED]);
    return counts[FAILED] ? 1 : 0;
  }
  if (chosen.list) return 0;
  if (library_missing()[0]) printf("the library lacks: %s\n", library_missing());
  printf("%u passed, %u failed, %u skipped\n", counts[PASSED], counts[FAILED], counts[SKIPPED]);
  return counts[FAILED] ? 1 : 0;
}
