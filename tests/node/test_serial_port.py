"""Serial ports of a simulated vehicle, in virtual time."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.gnss import NmeaFramer
from mavstack.node.serial_port import device_number, port_names


def test_names_of_ports():
    assert {"gps1", "telem2", "shell", "serial9"} <= set(port_names())
    assert device_number("GPS1") == common.SerialControlDev.DEV_GPS1
    assert device_number(100) == common.SerialControlDev.SERIAL0
    for wrong in ("gps9", -1, 256):
        with pytest.raises(InvalidArgumentError, match="there are telem1"):
            device_number(wrong)


def test_the_receiver_of_a_simulated_vehicle(virtual_vehicle):
    async def flight(vehicle):
        await vehicle.rtk.wait_for_fix(3, timeout=60)
        framer, found = NmeaFramer(), []
        async with vehicle.component.serial.open("gps1") as port:
            port.write(b"\xb5\x62\x0a\x04\x00\x00\x0e\x34")
            async for data in port:
                found += framer.feed(data)
                if len(found) >= 4:
                    break
        assert [body[:5] for body in found] == ["GPGGA", "GPRMC"] * 2
        assert framer.bad_lines == 0
        for wrong in ({"baudrate": -1}, {"poll": 0}):
            with pytest.raises(InvalidArgumentError):
                vehicle.component.serial.open("gps1", **wrong)

    virtual_vehicle.run(flight)
