# SPDX-License-Identifier: Apache-2.0
"""Parses C types of the description, and names structs in other languages."""
import dataclasses
import re

# Structs other than messages that the library's functions take or return.
CALLS = ["odo_session_options", "odo_statistics", "odo_anchor_place", "odo_anchor", "odo_ray", "odo_hit", "odo_map_point"]
FORM = re.compile(r"(?:const )?(?:struct )?(?P<base>\w+)(?P<stars>(?: ?\*(?:const )?)*) ?(?P<name>\w+)?(?:\[(?P<count>\d+)\])?")


@dataclasses.dataclass
class CType:
    base: str  # type without const and struct
    pointers: int
    count: int  # 0: no array
    const: bool  # the target is const
    arguments: list = None  # of a function pointer; the other members describe its result
    name: str = ""  # name of the parameter

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
    """Structs with a name in each language: messages, their elements, and structs that functions take or return."""
    return [*description.messages(), *filter(description.is_element, description.structs), *CALLS]


def is_event(number):
    return number >> 12 == 1
