"""Shows that vehicles fly by themselves."""

from __future__ import annotations

import struct

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.sim.vehicle_types import VehicleType
from mavstack.swarm.shows.reading import parse_show
from mavstack.swarm.shows.skyb import write_skyb
from mavstack.vehicle.swarm.skybrush import SHOW_PATH, Authorisation, start_message, upload_show
from tests.swarm.shows.samples import skyc
from tests.vehicle.world import ARDUPILOT, fly


def test_the_start_message_has_time_and_authorisation():
    message = start_message(345600.25, Authorisation.REHEARSAL, milliseconds_until_start=9000)
    assert (message.type, message.len) == (0x5C, 12)
    assert struct.unpack("<BiBiH", bytes(message.data)[:12]) == (1, 345600, 2, 9000, 250)
    assert struct.unpack_from("<i", bytes(start_message(None).data), 1) == (-0x80000000,)
    with pytest.raises(InvalidArgumentError):
        start_message(700_000.0)


def test_files_are_uploaded_and_read_by_the_vehicle():
    show = parse_show(skyc(1))

    async def scenario(world, vehicle):
        group = await world.node.wait_for_vehicles(1)
        results = await upload_show(group, show)
        assert await vehicle.ftp.download(SHOW_PATH) == write_skyb(show.vehicles[0])
        # The simulated vehicle has no firmware of Skybrush, and does not know its command.
        assert "USER_1" in str(results.errors.get(vehicle, "USER_1"))
        with pytest.raises(InvalidArgumentError, match="the show has 3 vehicles"):
            await upload_show(group, parse_show(skyc(3)))

    fly((VehicleType.COPTER, ARDUPILOT), scenario)
