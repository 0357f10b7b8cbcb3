# SPDX-License-Identifier: Apache-2.0
"""C types as the description spells them, taken apart, and the names that other languages give the structs."""
import dataclasses
import re

# Beside the messages, what an app hands to and takes from the library's functions.
CALLS = ["odo_session_options", "odo_statistics", "odo_anchor_place", "odo_anchor"]
FORM = re.compile(r"(?:const )?(?:struct )?(?P<base>\w+)(?P<stars>(?: ?\*(?:const )?)*) ?(?P<name>\w+)?(?:\[(?P<count>\d+)\])?")


@dataclasses.dataclass
class CType:
    base: str  # without const and struct
    pointers: int
    count: int  # 0: no array
    const: bool  # of what it points to
    arguments: list = None  # of a pointer to a function, whose result is the rest
    name: str = ""  # of the parameter

    @property
    def is_function(self):
        return self.arguments is not None


def parse(text):
    function = re.fullmatch(r"(.*) \(ODO_CALL \*\)\((.*)\)", text)
    if function:
        made = parse(function[1])
        made.arguments = [parse(argument) for argument in function[2].split(", ")]
        return made
    found = FORM.fullmatch(text)
    return CType(found["base"], found["stars"].count("*"), int(found["count"] or 0), text.startswith("const "), None, found["name"] or "")


def title(name):
    """odo_vo_motion: VoMotion."""
    return "".join(part.capitalize() for part in name[4:].split("_"))


def public_structs(description):
    """Those that have a name of their own in a language: messages, and what calls take and give."""
    return [*description.messages(), *CALLS]


def is_event(number):
    return number >> 12 == 1
