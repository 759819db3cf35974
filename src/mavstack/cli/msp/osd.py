"""`mav msp osd`: the items of Betaflight's on-screen display, and where they stand."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.msp.connection import run_on_controller
from mavstack.cli.msp.settings import NOT_SAVED
from mavstack.errors import MspDenied, MspFirmwareError
from mavstack.msp.messages.osd import OsdCanvas, OsdConfig
from mavstack.msp.messages.osd_items import OSD_ITEMS, OsdPosition

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.flight_controller import FlightController

#: Number of columns and rows of the OSD of analog video.
ANALOG_SIZE: Final = (30, 16)
_POSITION: Final = re.compile(r"(\d+),(\d+)")
_HIDDEN: Final = "off"


def osd(arguments: Namespace) -> int:
    """Run `mav msp osd`."""
    changes = _parse(arguments.words)

    async def work(controller: FlightController) -> int:
        items = await _items(controller)
        if changes:
            await _apply(controller, arguments, items, changes)
            return 0
        size = await _size(controller)
        if arguments.json:
            echo_json(_document(items, size))
        elif arguments.draw:
            echo(*draw(items, size, arguments.profile))
        else:
            echo(*align_columns(_rows(items)))
        return 0

    return run_on_controller(arguments, work)


def draw(items: dict[str, OsdPosition], size: tuple[int, int], profile: int) -> list[str]:
    """Return a picture of a profile: the name of each item where it begins."""
    columns, rows = size
    screen = [["·"] * columns for _ in range(rows)]
    for name, place in sorted(items.items(), key=lambda item: (item[1].row, item[1].column)):
        if profile in place.profiles and place.row < rows:
            for column, letter in enumerate(name[: max(columns - place.column, 0)], place.column):
                screen[place.row][column] = letter
    return ["".join(row) for row in screen]


async def _items(controller: FlightController) -> dict[str, OsdPosition]:
    if not controller.info.is_betaflight:
        answer = f"{controller.info.firmware} has another layout; use `mav msp cli`"
        raise MspFirmwareError("reading the OSD of", controller.name, answer=answer)
    with suppress(MspDenied):
        config = await controller.get(OsdConfig)
        if config.items:
            return {_name(index): OsdPosition.from_bits(bits) for index, bits in enumerate(config.items)}
    raise CommandError(f"{controller.name} has no on-screen display")


async def _size(controller: FlightController) -> tuple[int, int]:
    with suppress(MspDenied):
        canvas = await controller.get(OsdCanvas)
        if canvas.columns and canvas.rows:
            return canvas.columns, canvas.rows
    return ANALOG_SIZE


async def _apply(
    controller: FlightController,
    arguments: Namespace,
    items: dict[str, OsdPosition],
    changes: dict[str, tuple[int, int] | None],
) -> None:
    for name in changes:
        if name not in items:
            near = get_close_matches(name, items, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise CommandError(f"there is no item {name}{hint}")
    names = list(items)
    wanted = {name: _changed(items[name], place, arguments.profile) for name, place in changes.items()}
    for name, place in wanted.items():
        await controller.settings.set(f"BF_OSD_{names.index(name)}_POS", place.to_bits())
    if arguments.json:
        echo_json({name: _place_document(place) for name, place in wanted.items()})
    else:
        echo(*(f"{name}: {_place(items[name])} → {_place(place)}" for name, place in wanted.items()))
    if arguments.save:
        await controller.save()
    else:
        echo(NOT_SAVED, error=True)


def _changed(old: OsdPosition, place: tuple[int, int] | None, profile: int) -> OsdPosition:
    others = tuple(each for each in old.profiles if each != profile)
    if place is None:
        return replace(old, profiles=others)
    return replace(old, column=place[0], row=place[1], profiles=tuple(sorted((*others, profile))))


def _parse(words: list[str]) -> dict[str, tuple[int, int] | None]:
    found: dict[str, tuple[int, int] | None] = {}
    for word in words:
        name, _, place = word.partition("=")
        match = _POSITION.fullmatch(place)
        if match is None and place.lower() != _HIDDEN:
            raise UsageError(
                f"{word!r} must be an item and its place, such as CROSSHAIRS=14,6 or CROSSHAIRS=off"
            )
        if match is not None and (int(match[1]) > 63 or int(match[2]) > 31):
            raise UsageError(f"{word!r}: the column must be 0 to 63, the row 0 to 31")
        found[name.upper()] = None if match is None else (int(match[1]), int(match[2]))
    return found


def _name(index: int) -> str:
    return OSD_ITEMS[index] if index < len(OSD_ITEMS) else f"ITEM_{index}"


def _place(place: OsdPosition) -> str:
    shown = ",".join(map(str, place.profiles))
    return f"{place.column},{place.row} in profile {shown}" if shown else _HIDDEN


def _rows(items: dict[str, OsdPosition]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("ITEM", "COLUMN", "ROW", "PROFILES")]
    for name, place in items.items():
        shown = ",".join(map(str, place.profiles)) or _HIDDEN
        rows.append((name, str(place.column), str(place.row), shown))
    return rows


def _document(items: dict[str, OsdPosition], size: tuple[int, int]) -> dict[str, object]:
    places = {name: _place_document(place) for name, place in items.items()}
    return {"columns": size[0], "rows": size[1], "items": places}


def _place_document(place: OsdPosition) -> dict[str, object]:
    return {"column": place.column, "row": place.row, "profiles": list(place.profiles)}
