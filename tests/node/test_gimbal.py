"""A gimbal of a remote component, against one that a node offers."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionTimeout, CommandDenied, InvalidArgumentError
from mavstack.services.gimbal import GimbalSetpoint, GimbalSticks
from tests.node.payload import PayloadPair, with_pair


def test_discovery_and_control() -> None:
    async def work(pair: PayloadPair) -> None:
        first, second = await pair.remote.list_gimbals()
        assert (first.device_id, second.device_id) == (1, 2)
        assert repr(second) == "<Gimbal 1/100 device 2>"
        assert (first.information.vendor, first.information.model) == ("Maker", "G1")
        assert first.information.pitch_range == pytest.approx((-90, 30))
        assert (await first.get_information()).device_id == 1
        assert (await first.get_status()).primary is None
        with pytest.raises(CommandDenied, match="DO_GIMBAL_MANAGER_PITCHYAW on 1/100 failed: DENIED"):
            await first.point(-20)
        await first.take_control()
        assert first.status.primary == pair.ground.address
        assert (await first.point(pitch=-20, yaw=10)).pitch == pytest.approx(-20, abs=1)
        with pytest.raises(CommandDenied):
            await second.point(-20)  # control was taken of the first alone
        await first.release_control()
        assert (await first.get_status()).primary is None

    with_pair(work)


def test_pointing() -> None:
    async def work(pair: PayloadPair) -> None:
        gimbal = pair.gimbal
        await gimbal.take_control(force=True)
        await gimbal.turn(yaw_rate=20)
        await asyncio.sleep(1)
        await gimbal.turn()
        assert gimbal.attitude.yaw == pytest.approx(20, abs=4)
        assert (await gimbal.center()).yaw == pytest.approx(0, abs=1)
        await gimbal.retract()
        await gimbal.point(yaw=-90, yaw_rate=30, wait=False)
        with pytest.raises(ActionTimeout, match="pointing the gimbal of 1/100 failed: no progress for 5 s"):
            await gimbal.point(pitch=90)
        assert gimbal.attitude.yaw == pytest.approx(-90, abs=1)
        await gimbal.set_roi(47.0, 8.0, 10.0)
        await gimbal.set_roi_system(2)
        await gimbal.clear_roi()

    with_pair(work)


def test_streams() -> None:
    async def work(pair: PayloadPair) -> None:
        gimbal = pair.gimbal
        await gimbal.take_control()
        async with gimbal.control(rate=10) as control:
            control.set(GimbalSetpoint(pitch=-30))
            await asyncio.sleep(2)
            assert gimbal.attitude.pitch == pytest.approx(-30, abs=0.5)
            control.set(GimbalSticks(pitch_rate=1.0))
            await asyncio.sleep(0.5)
            control.set(GimbalSticks(pitch_rate=0.0))
            await asyncio.sleep(0.5)
        assert gimbal.attitude.pitch == pytest.approx(-15, abs=4)

    with_pair(work)


def test_arguments_are_checked_before_anything_is_sent() -> None:
    async def work(pair: PayloadPair) -> None:
        gimbal = pair.gimbal
        with pytest.raises(InvalidArgumentError, match="needs a pitch or a yaw"):
            await gimbal.point()
        with pytest.raises(InvalidArgumentError, match="-180 to 180"):
            await gimbal.point(pitch=200)
        with pytest.raises(InvalidArgumentError, match="no location"):
            await gimbal.set_roi(100, 8)
        with pytest.raises(InvalidArgumentError, match="1 to 255"):
            pair.remote.gimbal_device(0)

    with_pair(work)
