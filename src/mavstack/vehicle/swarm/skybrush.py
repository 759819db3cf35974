"""Shows that vehicles fly by themselves, with the firmware of Skybrush: files, start time, authorisation.

Each vehicle gets its `.skyb` file by FTP and a command that reads it. Start time and authorisation are sent
to all vehicles at once, as DATA16 of type 0x5C; a program repeats them until the show begins, since no
vehicle acknowledges them.
"""

from __future__ import annotations

import posixpath
import struct
from contextlib import suppress
from enum import IntEnum
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import FileDenied, InvalidArgumentError
from mavstack.swarm.shows.skyb import write_skyb

if TYPE_CHECKING:
    from mavstack.swarm.shows.show import Show
    from mavstack.vehicle.group import Group, Results
    from mavstack.vehicle.vehicle import Vehicle

#: The path of the show file on a vehicle.
SHOW_PATH: Final = "/collmot/show.skyb"
#: Type of DATA16 for packets of Skybrush from the ground.
GROUND_PACKET: Final = 0x5C
_START_TIME: Final = 1
#: The start time that means no change.
KEEP_START_TIME: Final = 0x7FFFFFFF
#: The start time that means no start.
CLEAR_START_TIME: Final = -0x80000000
#: The number of seconds in a week.
WEEK: Final = 604_800


class Authorisation(IntEnum):
    """The permission of vehicles at the start time."""

    NONE = 0
    LIVE = 1
    REHEARSAL = 2
    LIGHTS_ONLY = 3


async def upload_show(group: Group, show: Show, *, timeout: float | None = None) -> Results[None]:
    """Upload the trajectory and the lights of each vehicle, and let it read them.

    Args:
        group: The vehicles, in the order of those of the show.
        show: The show.
        timeout: Seconds for each step of a vehicle; None: until retries are exhausted.

    Returns:
        The outcome of each vehicle; its errors are those of FTP and of commands.

    Raises:
        InvalidArgumentError: The show has another number of vehicles, or does not fit into the format.
    """
    if len(group) != len(show.vehicles):
        raise InvalidArgumentError(f"the show has {len(show.vehicles)} vehicles, the group has {len(group)}")
    files = {vehicle: write_skyb(each) for vehicle, each in zip(group, show.vehicles, strict=True)}

    async def upload(vehicle: Vehicle) -> None:
        with suppress(FileDenied):  # the directory exists already
            await vehicle.ftp.make_directory(posixpath.dirname(SHOW_PATH), timeout=timeout)
        await vehicle.ftp.upload(SHOW_PATH, files[vehicle], timeout=timeout)
        await vehicle.command(common.MavCmd.USER_1, 0.0, timeout=timeout)

    return await group.each(upload, name="uploading the show")


def start_message(
    seconds_of_week: float | None,
    authorisation: Authorisation = Authorisation.NONE,
    *,
    milliseconds_until_start: int = -1,
) -> ardupilotmega.Data16:
    """Return the message with start time and authorisation.

    Args:
        seconds_of_week: GPS time of the start, seconds since Sunday; None clears the start time.
        authorisation: What vehicles may do then.
        milliseconds_until_start: For vehicles without GPS time; negative: not known.

    Raises:
        InvalidArgumentError: The time is not in a week.
    """
    whole, part = CLEAR_START_TIME, 0
    if seconds_of_week is not None:
        if not 0.0 <= seconds_of_week < WEEK:
            raise InvalidArgumentError(f"seconds_of_week must be from 0 to {WEEK}, got {seconds_of_week:g}")
        whole, part = divmod(round(seconds_of_week * 1000.0), 1000)
    packet = struct.pack("<BiBiH", _START_TIME, whole, authorisation, milliseconds_until_start, part)
    return ardupilotmega.Data16(type=GROUND_PACKET, len=len(packet), data=packet.ljust(16, b"\0"))
