# SPDX-License-Identifier: Apache-2.0
"""Generates a C program that writes every message with a different number in each field, and reads such bytes into a digest,
field by field. Every layout must read the same digest from the bytes of any other. Pointers are omitted."""

HEAD = """
static uint64_t next;
static double number(void) { return (double)(++next % 99 + 1); }
static uint64_t mix(uint64_t digest, double value) { return (digest ^ (uint64_t)(int64_t)value) * 1099511628211u; }
"""
TAIL = """
uint64_t odo_read(const unsigned char *bytes, uint32_t size, uint32_t type, uint32_t grown);
uint64_t odo_read(const unsigned char *bytes, uint32_t size, uint32_t type, uint32_t grown) {
  uint64_t digest = 14695981039346656037u;
  uint32_t at = 0;
  while (at < size) {
    const odo_header *message = (const odo_header *)(const void *)(bytes + at);
    if (message->type == type) switch (type) {
%s
      default: return 0;
    }
    at += message->struct_size;
  }
  return digest;
}
uint32_t odo_write(unsigned char *bytes);
uint32_t odo_write(unsigned char *bytes) {
  uint32_t at = 0;
  next = 0;
%s
  return at;
}
const uint32_t odo_types[] = {%s 0};
"""


def fields(abi, struct, place):
    """Yields (expression, count, field of the message) of every number in a struct and in embedded structs."""
    for field in abi.structs[struct].fields:
        base, _, count = field.type.partition("[")
        count = int(count.rstrip("]") or 1)
        if field.is_pointer or field.name == "struct_size":
            continue
        for i in range(count) if base in abi.structs else [None]:
            at = f"{place}{field.name}" + (f"[{i}]" if "[" in field.type and i is not None else "")
            if base in abi.structs:
                yield from ((e, n, field.name) for e, n, _ in fields(abi, base, at + "."))
            else:
                yield at + ("[i]" if "[" in field.type else ""), count, field.name


def exchange_c(abi):
    readers, cases, writes = [], [], []
    for name in abi.messages():
        numbers = [row for row in fields(abi, name, "") if row[0] != "header.type"]
        read = "\n".join(f"  if (ODO_HAS(m, {field}){' && grown' if field == 'grown' else ''}) "
                         f"for (i = 0; i < {count}; ++i) digest = mix(digest, (double)m->{expression});"
                         for expression, count, field in numbers)
        # Fields of a later version get separate numbers, so that all others equal those of the earlier version.
        write = "\n".join(f"  for (i = 0; i < {count}; ++i) m->{expression} = " +
                          (f"{500 + abi.messages()[name]} + i;" if field == "grown" else f"({kind(abi, name, expression)})number();")
                          for expression, count, field in numbers)
        readers.append(f"static uint64_t read_{name}(const {name} *m, uint64_t digest, uint32_t grown) {{\n  uint32_t i;\n  (void)grown;\n{read}\n"
                       f"  return digest;\n}}\nstatic uint32_t write_{name}({name} *m) {{\n  uint32_t i;\n{write}\n"
                       f"  m->header.struct_size = sizeof *m, m->header.type = {abi.messages()[name]}u;\n  return sizeof *m;\n}}")
        cases.append(f"      case {abi.messages()[name]}: digest = read_{name}((const {name} *)(const void *)message, digest, grown); break;")
        writes.append(f"  at += write_{name}(({name} *)(void *)(bytes + at));")
    types = "".join(f"{number}, " for number in abi.messages().values())
    return "#include <odograph/types.h>\n" + HEAD + "\n".join(readers) + TAIL % ("\n".join(cases), "\n".join(writes), types)


def kind(abi, struct, expression):
    """The C type of a number in a struct."""
    for part in expression.split("."):
        name = part.partition("[")[0]
        struct = next(f.type for f in abi.structs[struct].fields if f.name == name).partition("[")[0]
    return struct
