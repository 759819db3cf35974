"""`vehicle.rtk` with a simulated vehicle in virtual time."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import HealthTimeout, LinkURLError
from tests.gnss.test_rtcm import msm, station


def test_corrections_give_an_rtk_fix(virtual_vehicle):
    async def flight(vehicle):
        await vehicle.rtk.wait_for_fix(3, timeout=60)
        assert (vehicle.rtk.status.name, vehicle.rtk.status.is_corrected) == ("3D", False)
        with pytest.raises(HealthTimeout, match="the fix is 3D; no corrections were received from a source"):
            await vehicle.rtk.wait_for_fix(timeout=1)
        for second in range(20):
            sent = vehicle.rtk.send(station().data + msm(1074, second, 400).data + b"junk")
            assert sent == 2
            await asyncio.sleep(1)
        status = await vehicle.rtk.wait_for_fix(timeout=5)
        assert (status.name, status.is_fixed, status.is_corrected) == ("RTK fixed", True, True)
        assert status.horizontal_accuracy < 0.02
        counts = vehicle.rtk.counts
        assert (counts.frames, counts.bad_bytes, counts.too_long) == (40, 80, 0)
        assert counts.sent + counts.thinned == 40
        assert vehicle.rtk._gga().startswith(b"$GPGGA,")
        with pytest.raises(LinkURLError):
            vehicle.rtk.corrections("ntrip://")

    virtual_vehicle.run(flight)
