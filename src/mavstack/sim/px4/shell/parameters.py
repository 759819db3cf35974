"""`param`: show, compare, set and reset parameters."""

from __future__ import annotations

from fnmatch import fnmatchcase
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.services.parameters.value import as_type, same

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.services.parameters import ParameterDefinition, Value
    from mavstack.sim.parameters import Parameters
    from mavstack.sim.px4.shell.context import ShellContext

_REAL = common.MavParamType.REAL32
_USAGE = (
    "usage: param show [-c] [PATTERN] | set NAME VALUE | compare NAME VALUE\n"
    "       param reset NAME... | reset_all | save"
)


def param(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Run the subcommand in the first word."""
    parameters = context.vehicle.parameters
    match list(words):
        case ["show", "-c", *pattern]:
            yield from _show(parameters, "".join(pattern) or "*", changed=True)
        case ["show", *pattern]:
            yield from _show(parameters, "".join(pattern) or "*", changed=False)
        case ["set", name, value]:
            yield from _set(parameters, name, value)
        case ["compare", name, value]:
            equal = name in parameters and _number(value) == _number(_text(parameters[name]))
            yield "equal" if equal else "not equal"
        case ["reset", *names] if names:
            yield from _reset(parameters, names)
        case ["reset_all"]:
            parameters.reset()
        case ["save"]:
            yield "INFO  [param] saved"
        case _:
            yield _USAGE


def _show(parameters: Parameters, pattern: str, *, changed: bool) -> Iterator[str]:
    """List parameters that match a pattern."""
    yield "Symbols: x = used, + = saved"
    shown = 0
    for index, definition in enumerate(parameters.table):
        differs = not _is_default(definition)
        if fnmatchcase(definition.name, pattern) and (differs or not changed):
            yield f"x {'+' if differs else ' '} {definition.name} [{index}] : {_text(definition.value)}"
            shown += 1
    yield ""
    yield f" {shown}/{len(parameters)} parameters shown."


def _set(parameters: Parameters, name: str, value: str) -> Iterator[str]:
    """Set a parameter."""
    number = _number(value)
    if name not in parameters:
        yield f"ERROR [param] Parameter {name} not found."
    elif number is None:
        yield f"ERROR [param] {value} is no number."
    else:
        before = parameters[name]
        try:
            parameters.set(name, number if parameters.table[name].kind == _REAL else int(number))
        except MavstackError as error:
            yield f"ERROR [param] {error}"
            return
        yield f"  {name}: curr: {_text(before)} -> new: {_text(parameters[name])}"


def _reset(parameters: Parameters, names: Sequence[str]) -> Iterator[str]:
    """Reset parameters."""
    for name in names:
        if name not in parameters:
            yield f"ERROR [param] Parameter {name} not found."
            continue
        default = parameters.table[name].default
        if default is not None:
            parameters.set(name, default)


def _is_default(definition: ParameterDefinition) -> bool:
    """Return whether a parameter has its default value."""
    if definition.default is None:
        return True
    return same(as_type(definition.name, definition.default, definition.kind), definition.value)


def _number(text: str) -> float | None:
    """Parse a finite number; None if it is none."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if isfinite(number) else None


def _text(value: Value) -> str:
    """Format a value."""
    return f"{value:.4f}" if isinstance(value, float) else str(value)
