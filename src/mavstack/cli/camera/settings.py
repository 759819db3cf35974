"""`mav camera settings`: show or set what the definition file of a camera describes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.camera.selection import selected_camera
from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.selection import of_vehicle
from mavstack.errors import RemoteDenied

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.node.camera_settings import CameraSettings
    from mavstack.services.camera import SettingValue
    from mavstack.vehicle import Vehicle

MAX_FILE_BYTES = 4 * 1024 * 1024


def settings(arguments: Namespace) -> int:
    """Run `mav camera settings`."""
    definition = _definition_file(arguments.definition)

    async def work(vehicle: Vehicle) -> int:
        camera = await selected_camera(vehicle, arguments)
        found = camera.settings
        try:
            await found.load(definition)
        except RemoteDenied as error:
            if arguments.name is None or definition is not None:
                raise CommandError(str(error)) from None
        if arguments.name is None:
            _show_all(found, as_json=arguments.json)
        elif arguments.value is None:
            _show_one(found, arguments.name.upper(), as_json=arguments.json)
        else:
            await _set(vehicle, found, arguments)
        return 0

    return run_on_vehicle(arguments, work)


def _definition_file(path: str | None) -> bytes | None:
    if path is None:
        return None
    from mavstack.bounded_file import read_file_bounded

    return read_file_bounded(Path(path), MAX_FILE_BYTES)


def _row(found: CameraSettings, name: str) -> dict[str, object]:
    value = found.values.get(name)
    setting = found.definition.settings.get(name) if found.definition is not None else None
    row: dict[str, object] = {"name": name, "value": value}
    if setting is not None:
        row |= {
            "text": setting.text(value),
            "description": setting.description,
            "available": name in found.available,
            "options": list(found.options(name)),
        }
    return row


def _show_all(found: CameraSettings, *, as_json: bool) -> None:
    names = list(found.definition.settings if found.definition is not None else found.values)
    rows = [_row(found, name) for name in names]
    if as_json:
        echo_json(rows)
        return
    shown = [
        (
            str(row["name"]),
            str(row.get("text", row["value"])) + ("" if row.get("available", True) else " (no effect now)"),
            str(row.get("description", "")),
        )
        for row in rows
    ]
    echo(*align_columns(shown))


def _show_one(found: CameraSettings, name: str, *, as_json: bool) -> None:
    if name not in found.values:
        raise CommandError(f"the camera has no setting {name}; its settings: {', '.join(found.values)}")
    row = _row(found, name)
    if as_json:
        echo_json(row)
        return
    echo(f"{name}: {row.get('text', row['value'])}")
    options = row.get("options")
    if isinstance(options, list) and options:
        echo(f"options: {', '.join(options)}")


async def _set(vehicle: Vehicle, found: CameraSettings, arguments: Namespace) -> None:
    name: str = arguments.name.upper()
    value = _value(found, name, arguments.value)
    await found.set(name, value)
    row = _row(found, name)
    if arguments.json:
        echo_json({"system": vehicle.system, **row})
    else:
        echo(of_vehicle(vehicle, f"{name}: {row.get('text', row['value'])}"))


def _value(found: CameraSettings, name: str, word: str) -> SettingValue:
    """Return the value of a word; without a definition, of the type that the camera reported."""
    if found.definition is not None and name in found.definition.settings:
        return word
    known = found.values.get(name)
    if isinstance(known, str):
        return word
    try:
        return float(word) if isinstance(known, float) else int(word)
    except ValueError:
        raise CommandError(f"setting {name} takes a number, not {word!r}") from None
