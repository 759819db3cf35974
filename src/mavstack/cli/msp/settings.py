"""`mav msp get` and `mav msp set`: settings of a flight controller by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.msp.connection import run_on_controller
from mavstack.cli.param.text import matching

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Mapping

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp.settings import SettingDefinition, Value

NOT_SAVED = "not saved: the changes are lost at the next restart; --save keeps them"
_WILDCARDS = frozenset("*?[")


def get(arguments: Namespace) -> int:
    """Run `mav msp get`."""

    async def work(controller: FlightController) -> int:
        values = await _read(controller, [name.upper() for name in arguments.names])
        if arguments.json:
            echo_json(values)
        else:
            echo(
                *align_columns([_row(controller.settings.definition(name), values[name]) for name in values])
            )
        return 0

    return run_on_controller(arguments, work)


def set_values(arguments: Namespace) -> int:
    """Run `mav msp set`."""
    words = _parse(arguments.words)

    async def work(controller: FlightController) -> int:
        wanted = {name: _number(controller.settings.definition(name), text) for name, text in words.items()}
        changes = await apply(controller, wanted)
        report(arguments, changes)
        if arguments.save:
            await controller.save()
        elif changes:
            echo(NOT_SAVED, error=True)
        return 0

    return run_on_controller(arguments, work)


async def apply(controller: FlightController, wanted: Mapping[str, Value]) -> dict[str, tuple[Value, Value]]:
    """Write settings, after a check of all values; return the old and the new value of those that changed."""
    for name, value in wanted.items():
        controller.settings.definition(name).checked(value)
    changes: dict[str, tuple[Value, Value]] = {}
    for name, value in wanted.items():
        old = await controller.settings.get(name)
        new = await controller.settings.set(name, value)
        if old != new:
            changes[controller.settings.definition(name).name] = (old, new)
    return changes


def report(arguments: Namespace, changes: Mapping[str, tuple[Value, Value]]) -> None:
    """Print what was changed."""
    if arguments.json:
        echo_json({name: new for name, (_, new) in changes.items()})
    else:
        lines = [f"{name}: {old:g} → {new:g}" for name, (old, new) in changes.items()]
        echo(*(lines or ["nothing to change"]))


async def _read(controller: FlightController, names: list[str]) -> dict[str, Value]:
    if names and not any(_WILDCARDS & set(name) for name in names):
        return {name: await controller.settings.get(name) for name in names}
    with TransferProgress("reading settings", in_bytes=False) as progress:
        values = await controller.settings.all(progress)
    return matching(names, values, "setting")


def _row(definition: SettingDefinition, value: Value) -> tuple[str, ...]:
    meaning = definition.values.get(int(value), "") if definition.values else ""
    unit = f" {definition.unit}" if definition.unit else ""
    return definition.name, f"{value:g}{unit}", meaning, definition.description


def _parse(words: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for word in words:
        name, mark, value = word.partition("=")
        if not mark or not name.strip() or not value.strip():
            raise UsageError(f"{word!r} is no setting and value, such as BF_PID_ROLL_P=50")
        if name.strip().upper() in found:
            raise UsageError(f"{name.strip().upper()} is given twice")
        found[name.strip().upper()] = value.strip()
    return found


def _number(definition: SettingDefinition, text: str) -> Value:
    """Return the value of a text: a number, or the meaning of one."""
    for number, meaning in definition.values.items():
        if meaning.lower() == text.lower():
            return number
    try:
        return float(text) if "." in text or "e" in text.lower() else int(text, 0)
    except ValueError:
        meanings = ", ".join(definition.values.values())
        what = f"one of {meanings}, or a number" if meanings else "a number"
        raise UsageError(f"{definition.name} must be {what}, got {text!r}") from None
