"""Each error of a vehicle that the documentation shows is the text of the program."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import MavstackError
from tests.docs.blocks import ROOT, pages

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from mavstack.vehicle import Vehicle

#: The operation, the vehicle, the result, and the vehicle's own words, which depend on its state.
SHOWN = re.compile(r"([a-zA-Z][\w ]*?) (of |on )?1/1 failed: ([^`()\n]*?)(?: \([^`\n]*)?(?=[`\n]|$)")


def shown() -> set[str]:
    """The errors in the documentation without the vehicle's own words."""
    found = set()
    for path in (ROOT / "README.md", *pages()):
        for operation, link, reason in SHOWN.findall(path.read_text("utf-8")):
            found.add(f"{operation} {link}1/1 failed: {reason.strip()}")
    return found


async def text_of(call: Awaitable[object]) -> str:
    """Return the error of a call without the vehicle's own words."""
    with pytest.raises(MavstackError) as caught:
        await call
    return str(caught.value).partition(" (")[0]


def test_errors_in_the_documentation_are_those_of_the_program(virtual_vehicle) -> None:
    async def fail(vehicle: Vehicle) -> set[str]:
        refused = await text_of(vehicle.arm())  # it has just been started
        await vehicle.wait_until_ready()
        takeoff = await text_of(vehicle.takeoff(10))
        command = vehicle.component.command(common.MavCmd.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10)
        return {refused, takeoff, await text_of(command)}

    produced = virtual_vehicle.run(fail)
    conflict = {each for each in shown() if "vehicles use system id" in each}  # tested beside its page
    assert shown() - conflict == produced
