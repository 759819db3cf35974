"""Gimbals over random networks: the gimbal points where it shall, or a typed error follows in time."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionTimeout, CommandDenied, RemoteError, RemoteTimeout
from mavstack.services.gimbal import GimbalSetpoint, ListGimbals, PointGimbal, TakeControl
from tests.services.gimbal.harness import MANAGER, GimbalHarness
from tests.services.network import GROUND, random_impairment, with_cuts
from tests.services.single_service import deliver, random_message

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    random = Random(seed)
    harness = GimbalHarness(*random.choice([(1,), (1, 2)]), seed=seed, impairment=random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    if random.random() < 0.2:
        harness.network.at(random.uniform(0, 5), harness.manager.restart)
    listing = harness.run(ListGimbals())
    if listing.error is None:
        numbers = [each.device_id for each in listing.result()]
        assert set(numbers) <= set(harness.device_ids)
    else:
        assert isinstance(listing.error, RemoteTimeout)
    taken = harness.run(TakeControl(GROUND))
    pitch = random.uniform(-80, 20)
    pointing = PointGimbal(GimbalSetpoint(pitch=pitch), 1, lambda: harness.monitor.attitude(1))
    pointed = harness.run(pointing)
    if pointed.error is None:
        assert taken.error is None or harness.server.status(1).primary == GROUND
        assert pointed.result().pitch == pytest.approx(pitch, abs=2.0)
    else:
        assert isinstance(pointed.error, CommandDenied | ActionTimeout | RemoteTimeout)


def test_gimbals_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)


@pytest.mark.parametrize(
    "kind",
    [
        common.GimbalManagerSetPitchyaw,
        common.GimbalManagerSetAttitude,
        common.GimbalManagerSetManualControl,
        common.GlobalPositionInt,
        common.Attitude,
        common.GimbalManagerInformation,
        common.GimbalManagerStatus,
        common.GimbalDeviceInformation,
        common.GimbalDeviceAttitudeStatus,
    ],
)
def test_garbage_does_no_harm(kind) -> None:
    random = Random(1)
    harness = GimbalHarness()
    harness.run(TakeControl(GROUND)).result()
    for _ in range(200):
        message = random_message(kind, random)
        deliver(harness.server, message, GROUND, harness.network.now)
        deliver(harness.server, message, MANAGER._replace(component=1), harness.network.now)
        deliver(harness.monitor, message, MANAGER, harness.network.now)
    harness.let_pass(1)
    assert len(harness.monitor.informations) <= 16
    assert harness.monitor.attitude() is None or isinstance(harness.monitor.attitude().pitch, float)
    operation = harness.run(PointGimbal(GimbalSetpoint(pitch=-5), 1, lambda: None, wait=False))
    assert operation.error is None or isinstance(operation.error, RemoteError)
