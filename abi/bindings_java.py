# SPDX-License-Identifier: Apache-2.0
"""Generates the Java and Kotlin binding: constants, messages as views of native memory, functions and their JNI implementation in C.
generate.py writes the returned text."""
from c_types import parse, public_structs, title

JAVA = {"uint8_t": "byte", "int32_t": "int", "uint32_t": "int", "int64_t": "long", "uint64_t": "long", "float": "float", "double": "double"}
GET = {"byte": "", "int": "Int", "long": "Long", "float": "Float", "double": "Double"}
SKIPPED = {"struct_size", "reserved"}
SIZES = {"byte": 1, "int": 4, "long": 8, "float": 4, "double": 8}


def members(description, name, base=0, prefix=""):
    """Yields name, Java type, offset and count of each number or array, with embedded structs flattened."""
    for field in description.structs[name].fields:
        kind, at, label = parse(field.type), base + field.offset, prefix + field.name
        if field.is_pointer:
            yield label, "long", at, 1
        elif kind.base == "char":
            yield label, "text", at, kind.count
        elif kind.base in JAVA:
            yield label, JAVA[kind.base], at, kind.count or 1
        else:
            inner = "" if field.name == "header" else label
            for i in range(kind.count or 1):
                size = description.structs[kind.base].size
                yield from members(description, kind.base, at + i * size, inner and f"{inner}{i if kind.count else ''}_")


def accessors(owner, label, kind, at, count):
    if kind == "text":
        return [f"public String {label}() {{ return text({at}, {count}); }}"]
    get, put = f"memory.get{GET[kind]}", f"memory.put{GET[kind]}"
    if count == 1:
        return [f"public {kind} {label}() {{ return {get}({at}); }}",
                f"public {owner} {label}({kind} value) {{ {put}({at}, value); return this; }}"]
    each = f"for (int i = 0; i < {count}; ++i)"
    step = f"{at} + {SIZES[kind]} * i"
    return [f"public {kind} {label}(int i) {{ return {get}({step}); }}",
            f"public {kind}[] {label}() {{ {kind}[] values = new {kind}[{count}]; {each} values[i] = {label}(i); return values; }}",
            f"public {owner} {label}({kind}... values) {{ {each} {put}({step}, values[i]); return this; }}"]


def message(description, name):
    struct, owner, number = description.structs[name], title(name), description.messages().get(name)
    lines = [f"    public static final class {owner} extends Struct {{", f"        public static final int SIZE = {struct.size};"]
    if number is not None:
        lines += [f"        public static final int TYPE = {number:#x};",
                  f"        public {owner}(long t_ns) {{ super(SIZE); memory.putInt(4, TYPE).putLong(8, t_ns); }}",
                  f"        public {owner}(Event event) {{ super(SIZE); copy(event, TYPE); }}"]
    elif description.is_element(name):
        lines += [f"        {owner}(Event event, int at) {{ super(SIZE); copyElement(event, at); }}"]
    else:
        lines += [f"        public {owner}() {{ super(SIZE); }}"]
    for label, kind, at, count in members(description, name):
        if label not in SKIPPED:
            lines += ["        " + text for text in accessors(owner, label, kind, at, count)]
    return "\n".join(lines + ["    }"])


def java_type(kind):
    if kind.pointers or kind.is_function or kind.base in ("odo_callback", "odo_plugin_entry"):
        return "long"
    return JAVA.get(kind.base, kind.base)


def java(description):
    constants = []
    for name, value in description.constants.items():
        if isinstance(value, str):
            constants.append(f'    public static final String {name} = "{value}";')
        elif -2**31 <= value < 2**32:
            constants.append(f"    public static final int {name} = {value - 2**32 if value >= 2**31 else value};")
        else:
            constants.append(f"    public static final long {name} = {value}L;")
    functions = []
    for f in description.exported():
        parameters = ", ".join(f"{java_type(parse(p))} {parse(p).name}" for p in f.parameters)
        result = "String" if parse(f.result).base == "char" else java_type(parse(f.result))
        functions.append(f"    static native {result} {f.name}({parameters});")
    return ("// SPDX-License-Identifier: Apache-2.0\n// Written by abi/generate.py; do not edit.\npackage org.odograph;\n\n"
            "/** Constants and messages with their C names, documented in the C headers. Unsigned numbers are represented as signed ones. */\n"
            "public final class Abi {\n    private Abi() {}\n    static { System.loadLibrary(\"odograph_jni\"); }\n\n" + "\n".join(constants) + "\n\n" +
            "\n".join(functions) + "\n\n" + "\n".join(message(description, name) for name in public_structs(description)) + "\n}\n")


def jni(description):
    def c_type(text):
        kind = parse(text)
        return {"long": "jlong", "int": "jint", "void": "void"}[java_type(kind)]

    lines = []
    for f in description.exported():
        mangled = "Java_org_odograph_Abi_" + f.name.replace("_", "_1")
        parameters = "".join(f", {c_type(p)} {parse(p).name}" for p in f.parameters)
        arguments = ", ".join(f"({p[:len(p) - len(parse(p).name)].strip()})" + ("(intptr_t)" if java_type(parse(p)) == "long" and (
            parse(p).pointers or parse(p).base in ("odo_callback", "odo_plugin_entry")) else "") + parse(p).name for p in f.parameters)
        result = parse(f.result)
        if result.base == "char":
            head, call = "jstring", f"return (*env)->NewStringUTF(env, {f.name}({arguments}));"
        elif f.result == "void":
            head, call = "void", f"{f.name}({arguments});"
        else:
            head, call = c_type(f.result), f"return ({c_type(f.result)}){f.name}({arguments});"
        unused = "(void)self;" if result.base == "char" else "(void)env, (void)self;"
        lines.append(f"JNIEXPORT {head} JNICALL {mangled}(JNIEnv *env, jclass self{parameters}) {{\n  {unused}\n  {call}\n}}")
    return ("/* SPDX-License-Identifier: Apache-2.0\n *\n * Written by abi/generate.py; do not edit. The other end of Abi.java's functions.\n */\n"
            "#include <jni.h>\n#include <stdint.h>\n\n#include <odograph/anchor.h>\n#include <odograph/map.h>\n#include <odograph/recording.h>\n#include <odograph/scene.h>\n\n/* clang-format off */\n" + "\n".join(lines) + "\n/* clang-format on */\n")
