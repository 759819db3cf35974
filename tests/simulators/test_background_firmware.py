"""The fixture `firmware`, with a stand-in for ArduPilot."""

from __future__ import annotations

import time

import pytest

from mavstack import sync
from mavstack.errors import InvalidStateError
from mavstack.simulators.background_firmware import BackgroundFirmware
from mavstack.simulators.firmware_session import FirmwareOptions
from tests.simulators.test_firmware_session import options


def test_a_firmware_in_a_test(firmware):
    made = options()
    flight = firmware(
        "ardupilot", made.binary, listen=made.listen, instance=made.instance, out=made.out, seed=4
    )
    with sync.connect(flight.url) as connection:
        assert connection.wait_for_vehicle(timeout=60).address.system == 1
    flight.inject("gps-lost", after=1.0)
    end = time.monotonic() + 30
    while "gps-lost" not in flight.simulator.sensors.faults.active:
        assert time.monotonic() < end
        time.sleep(0.01)
    assert flight.events == ["ArduPilot is connected"]
    assert "waiting for connection" in flight.lines


def test_a_firmware_that_is_not_running_takes_no_calls():
    with pytest.raises(InvalidStateError, match="the firmware is not running"):
        BackgroundFirmware(FirmwareOptions("ardupilot")).inject("gps-lost")
