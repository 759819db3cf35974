"""A node logs its components, conflicts and refused signatures, and never a key."""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import memory_pair
from mavstack.node import Node
from mavstack.node.log_events import log_event
from mavstack.security import SigningKey
from mavstack.services import Address
from mavstack.services.signing_setup import KeySettled
from mavstack.sim.virtual import run_virtually
from tests.waiting import wait_until

if TYPE_CHECKING:
    import pytest

PX4 = common.MavAutopilot.PX4
OURS, THEIRS = SigningKey.from_passphrase("ours"), SigningKey.from_passphrase("theirs")


async def run_pair(seconds: float, ground_key: SigningKey | None, vehicle_key: SigningKey | None) -> None:
    """Let a ground station and a vehicle run on one link, until the vehicle is lost."""
    one, other = memory_pair(asyncio.get_running_loop().time)
    async with Node(one, signing=ground_key) as ground:
        async with Node(other, system=1, component=1, autopilot=PX4, signing=vehicle_key):
            await asyncio.sleep(seconds)
        if ground.components:
            await wait_until(lambda: not any(each.alive for each in ground.components.values()))


def records(caplog: pytest.LogCaptureFixture) -> list[tuple[int, str]]:
    return [(each.levelno, each.getMessage()) for each in caplog.records if each.name == "mavstack.node"]


def test_found_and_lost_components_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "mavstack.node"):
        run_virtually(run_pair(3, None, None))
    logged = records(caplog)
    assert any(level == logging.INFO and "component 1/1 found" in text for level, text in logged)
    assert any(level == logging.WARNING and "component 1/1 lost" in text for level, text in logged)


def test_refused_signatures_are_logged_at_intervals_and_without_keys(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with caplog.at_level(logging.DEBUG):
        run_virtually(run_pair(25, OURS, THEIRS))
    refused = [text for level, text in records(caplog) if level == logging.WARNING and "refused" in text]
    assert 2 <= len(refused) <= 6  # of more than fifty packets on two sides
    for key in (OURS, THEIRS):
        for form in (key._secret.hex(), repr(key._secret)):
            assert form not in caplog.text


def test_a_settled_key_is_logged_by_its_peer_alone(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "mavstack.node"):
        log_event(KeySettled(Address(1, 1), OURS, True))
    assert records(caplog) == [(logging.INFO, "signing key of 1/1 changed")]
