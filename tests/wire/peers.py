"""pymavlink as a peer: modules that its generator writes from our definitions."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import mavstack.dialects

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition

DEFINITIONS = Path(mavstack.dialects.__file__).parent / "definitions"


def generate(dialect: str, wire_protocol: str, folder: Path) -> ModuleType:
    """Return the module of pymavlink for one of our definition files."""
    from pymavlink.generator import mavgen

    path = folder / f"peer_{dialect}_{wire_protocol[0]}.py"
    options = mavgen.Opts(str(path), wire_protocol=wire_protocol, language="Python3", validate=False)
    with contextlib.redirect_stdout(io.StringIO()):
        assert mavgen.mavgen(options, [str(DEFINITIONS / f"{dialect}.xml")])
    text = path.read_text("utf-8")
    # The second half has methods to encode and send each message, which are not needed and slow to compile.
    codec = text.index("class MAVLink(object)")
    methods = re.compile(r"^    def \w+_encode\(self", re.MULTILINE).search(text, codec)
    text = text[: methods.start()] if methods else text
    module = ModuleType(path.stem)
    exec(compile(text, str(path), "exec", dont_inherit=True), module.__dict__)
    return module


def link(module: ModuleType, system: int = 1, component: int = 1) -> Any:
    """Return one end of a pymavlink link, without `robust_parsing`, so that damaged input raises."""
    return module.MAVLink(None, srcSystem=system, srcComponent=component)


def argument(field: FieldDefinition, value: Any) -> Any:
    """Convert a field value to the form of pymavlink's constructors."""
    if field.type == "char":
        return value if field.array_length else value or b"\0"
    if isinstance(value, bytes | tuple):
        # Its generator does not distinguish an array of one element from a single value.
        return list(value) if len(value) > 1 else value[0]
    return value


def message(module: ModuleType, message_id: int, fields: dict[FieldDefinition, Any]) -> Any:
    """Create a message of pymavlink; `fields` must be those of its module, in the order of the definition."""
    message_class = module.mavlink_map[message_id]
    return message_class(*[argument(field, value) for field, value in fields.items()])


def raw_value(message: Any, field: FieldDefinition) -> Any:
    """Return the value of a field that pymavlink decoded; a text as raw bytes."""
    if field.type == "char":
        return getattr(message, f"_{field.name}_raw")
    value = getattr(message, field.name)
    return value if not field.array_length or isinstance(value, list) else [value]
