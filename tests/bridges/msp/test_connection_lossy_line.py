"""Requests over a serial line that loses and damages bytes, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.errors import MspDenied, MspError, MspTimeout
from mavstack.links import Impairment
from mavstack.msp import Priority
from mavstack.msp.messages.sensors import Attitude
from mavstack.msp.settings import Settings
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.controllers import IDENTITY, Firmware, controller_of

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from tests.seeds import Seeds

SERIAL = Impairment(bandwidth=11520)  # 115,200 baud
ECHO, UNKNOWN = 118, 77


def answers(payload: bytes) -> bytes:
    """The reply holds its request, so that a reply to another request is seen."""
    return payload * 3


async def lossy_scenario(seed: int) -> None:
    random = Random(seed)
    loss = random.choice((0, 0.02, 0.2))
    line = Impairment(bandwidth=11520, loss=loss, latency=0.004, jitter=0.003, seed=seed)
    outcomes: list[object] = []
    with suppress(MspTimeout):  # the line was too bad to ask for the identity
        async with controller_of(Firmware({**IDENTITY, ECHO: answers}), line) as controller:
            for number in range(20):
                payload, start = bytes([number]) * random.randint(1, 40), asyncio.get_running_loop().time()
                try:
                    reply = await controller.request(ECHO, payload, timeout=2)
                except MspTimeout as error:
                    outcomes.append(error)
                else:
                    assert reply == answers(payload)
                assert asyncio.get_running_loop().time() - start < 2.01
            with suppress(MspTimeout), pytest.raises(MspDenied):
                await controller.request(UNKNOWN)
            assert loss == 0.2 or len(outcomes) <= 2


async def damaged_scenario(seed: int) -> None:
    line = Impairment(bandwidth=11520, loss=0.03, corrupt=0.005, duplicate=0.02, latency=0.002, seed=seed)
    with suppress(MspError):  # the identity was damaged
        async with controller_of(Firmware({**IDENTITY, ECHO: answers}), line) as controller:
            calls = [controller.request(ECHO, bytes([number]) * 8, timeout=3) for number in range(20)]
            results = await asyncio.gather(*calls, return_exceptions=True)
            assert all(isinstance(result, bytes | MspError) for result in results)
            assert sum(isinstance(result, bytes) for result in results) >= 1


@pytest.mark.flight
def test_each_request_ends_with_its_reply_or_a_typed_error(seeds: Seeds) -> None:
    seeds.check(lambda seed: run_virtually(lossy_scenario(seed)))


@pytest.mark.flight
def test_damaged_bytes_end_in_a_result_or_a_typed_error(seeds: Seeds) -> None:
    seeds.check(lambda seed: run_virtually(damaged_scenario(seed)))


@pytest.mark.parametrize("scenario", [lossy_scenario, damaged_scenario])
def test_a_few_lines(scenario: Callable[[int], Coroutine[None, None, None]]) -> None:
    for seed in range(3):
        run_virtually(scenario(seed))


def test_attitude_at_100_hertz_while_settings_are_read():
    async def main():
        firmware = Firmware({**IDENTITY, Attitude.COMMAND: bytes(6)})
        async with controller_of(firmware, SERIAL) as controller:
            for kind in Settings(controller.info).reads():
                firmware.replies[kind.COMMAND] = bytes(240)
            loop = asyncio.get_running_loop()
            start, latencies = loop.time(), []
            reading = asyncio.create_task(controller.settings.all())
            for number in range(200):
                await asyncio.sleep(max(start + number * 0.01 - loop.time(), 0))
                asked = loop.time()
                await controller.get(Attitude, priority=Priority.TELEMETRY)
                latencies.append(loop.time() - asked)
            assert loop.time() - start == pytest.approx(2.0, abs=0.05)  # no period was lost
            assert reading.done()
            assert len(reading.result()) > 100
            latencies.sort()
            assert latencies[100] < 0.005  # 18 bytes and the firmware's millisecond need 2.6 ms
            assert latencies[-1] < 0.03  # behind a reply of 240 bytes, which needs 21 ms

    run_virtually(main())
