# SPDX-License-Identifier: Apache-2.0
"""Generates the Rust binding: constants, structs, functions and type numbers of messages. generate.py writes the returned text."""
from c_types import parse, public_structs, title

SCALARS = {"uint8_t": "u8", "int32_t": "i32", "uint32_t": "u32", "int64_t": "i64", "uint64_t": "u64", "float": "f32", "double": "f64",
           "char": "c_char", "void": "c_void"}
WORDS = {"type": "kind"}  # reserved words of Rust
CALLBACKS = ("odo_callback", "odo_plugin_entry")
HEAD = """// SPDX-License-Identifier: Apache-2.0
// Written by abi/generate.py; do not edit.
//! The C ABI, documented in the headers of odograph.
#![allow(non_camel_case_types)]
use std::os::raw::{c_char, c_void};

#[cfg(not(target_pointer_width = "64"))]
compile_error!("pointers have 8 bytes in the structs of Odograph's ABI; this crate supports 64-bit targets");

/// A message: a struct that starts with an [`odo_header`] and is zero by default.
///
/// # Safety
/// The type must be `#[repr(C)]`, start with an [`odo_header`], and be valid for any bytes.
pub unsafe trait Message: Copy {
    /// ODO_TYPE_*
    const TYPE: u32;

    /// A zeroed message with size, type and time set.
    fn at(t_ns: i64) -> Self {
        unsafe {
            let mut made: Self = std::mem::zeroed();
            let header = &mut *(&mut made as *mut Self as *mut odo_header);
            header.struct_size = std::mem::size_of::<Self>() as u32;
            header.type_ = Self::TYPE;
            header.t_ns = t_ns;
            made
        }
    }
}
""".replace("type_", WORDS["type"])


ENTRY = """/// Exports a [`plugin::Plugin`](crate::plugin::Plugin) as the plugin of this library.
#[macro_export]
macro_rules! plugin {
    ($kind:ty) => {
        #[export_name = "@ENTRY@"]
        pub unsafe extern "C" fn odograph_plugin_entry(host: *const $crate::abi::odo_host, out: *mut $crate::abi::odo_plugin) -> i32 {
            static TABLE: $crate::plugin::Table = $crate::plugin::Table::new();
            TABLE.fill::<$kind>(host, out)
        }
    };
}"""


def rust_type(kind):
    if kind.is_function:
        arguments = ", ".join(rust_type(argument) for argument in kind.arguments)
        result = "" if kind.base == "void" and not kind.pointers else " -> " + pointed(kind)
        return f'Option<unsafe extern "C" fn({arguments}){result}>'
    return f"[{pointed(kind)}; {kind.count}]" if kind.count else pointed(kind)


def pointed(kind):
    name = SCALARS.get(kind.base, kind.base)
    if kind.base in CALLBACKS:
        return f"Option<{name}>"
    return ("*const " if kind.const else "*mut ") * kind.pointers + name


def signature(f):
    parameters = ", ".join(f"{parse(p).name}: {rust_type(parse(p))}" for p in f.parameters)
    result = parse(f.result)
    return f"({parameters})" + ("" if result.base == "void" and not result.pointers else " -> " + rust_type(result))


def rust(description, minimum):
    def constant(name, value):
        if isinstance(value, str):
            return f'pub const {name}: &str = "{value}";'
        status = name.startswith("ODO_E_") or name in ("ODO_OK", "ODO_NOT_READY", "ODO_END", "ODO_PARTIAL")
        kind = "i32" if status else "u32" if 0 <= value < 2**32 else "i64"
        return f"pub const {name}: {kind} = {value};"

    structs = []
    for struct in description.structs.values():
        lines = ["#[repr(C)]", "#[derive(Clone, Copy)]", f"pub struct {struct.name} {{"]
        lines += [f"    pub {WORDS.get(field.name, field.name)}: {rust_type(parse(field.type))}," for field in struct.fields]
        structs.append("\n".join(lines + ["}", f"impl Default for {struct.name} {{", "    fn default() -> Self {",
                                          "        unsafe { std::mem::zeroed() }", "    }", "}"]))
    opaque = [f"#[repr(C)]\npub struct {name} {{\n    _private: [u8; 0],\n}}" for name in description.opaque]
    callbacks = [f'pub type {f.name} = unsafe extern "C" fn{signature(f)};' for f in description.functions if f.kind == "callback"]
    functions = [f"    pub fn {f.name}{signature(f)};" for f in description.exported()]
    messages = [f"unsafe impl Message for {name} {{\n    const TYPE: u32 = {number:#x};\n}}" for name, number in description.messages().items()]
    aliases = [f"pub type {title(name)} = {name};" for name in public_structs(description)]
    return "\n\n".join([HEAD + "\n".join(constant(*item) for item in description.constants.items())
                        + f"\n/// Size of version 1.0 of the plugin's table.\npub const ODO_PLUGIN_SIZE_MIN: u32 = {minimum['odo_plugin']};", "\n".join(opaque), "\n".join(structs),
                        "\n".join(callbacks), ENTRY.replace("@ENTRY@", description.entry_symbol()), '#[cfg(feature = "app")]\n#[link(name = "odograph")]\nextern "C" {\n' + "\n".join(functions) + "\n}", "\n".join(messages),
                        "\n".join(aliases)]) + "\n"
