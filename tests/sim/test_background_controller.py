"""A simulated flight controller in a thread, as the pytest fixture `flight_controller` provides it."""

from __future__ import annotations

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.errors import InvalidStateError
from mavstack.pytest_plugin import flight_controller  # noqa: F401 (the fixture)
from mavstack.sim.background_controller import BackgroundFlightController


@pytest.mark.vehicle(firmware="inav")
async def test_a_client_reads_its_firmware(flight_controller):  # noqa: F811
    async with FlightController(flight_controller.url) as client:
        assert client.info.variant == "INAV"
    assert not flight_controller.call(lambda: flight_controller.controller.armed)


def test_it_is_called_only_while_it_runs():
    with pytest.raises(InvalidStateError, match="not running"):
        BackgroundFlightController().call(int)
