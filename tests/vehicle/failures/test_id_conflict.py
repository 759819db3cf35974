"""Every call that acts is refused while two vehicles use the system id, and the error names both.

The rows are those of the failure table, which `test_table` keeps complete: a new call is in one of the tables
here, or this test fails.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import pytest

from mavstack.errors import SystemIdConflictError
from mavstack.security.acting import acts
from mavstack.sim.virtual import run_virtually
from tests.vehicle.failures.calls import CALLS
from tests.vehicle.failures.rows import Call, call_name
from tests.vehicle.failures.scripted_autopilot import scripted_harness

#: The calls that read, wait or send nothing to the vehicle: they continue.
READING: Final = MappingProxyType(
    {
        "Vehicle": "wait_until_ready wait_for_message wait_for_telemetry get_home get_home_altitude "
        "get_position get_relative_altitude get_version find_cameras find_gimbals wait_for_camera",
        "Telemetry": "ensure request_home close",
        "MessageStream": "__anext__ __aenter__ __aexit__",
        "Mission": "download",
        "VehiclePlan": "download",
        "Params": "get download download_metadata",
        "Ftp": "list download checksum",
        "Logs": "list download",
        "Modes": "list",
        "CalibrationSession": "__aenter__ __aexit__ confirm",
        "Camera": "get_information get_status get_capture_status list_storages list_streams",
        "CameraSettings": "load get",
        "Gimbal": "get_information get_status",
    }
)
READING_NAMES = frozenset(f"{part}.{name}" for part, names in READING.items() for name in names.split())
ACTING = [call for call in CALLS if call.name not in READING_NAMES]


@dataclass(frozen=True)
class TwoSenders:
    """A conflict of two senders, as the discovery reports it."""

    senders: tuple[object, ...] = ()

    def is_separate(self, name: str) -> bool:
        return False

    def __str__(self) -> str:
        return "one on udpin 10.0.0.1:14550, one on udpin 10.0.0.2:14550"


async def outcome(harness, call: Call) -> BaseException | None:
    try:
        async with asyncio.timeout(100):
            await call.do(harness)
    except Exception as error:  # noqa: BLE001
        return error
    return None


async def in_conflict(call: Call):
    async with scripted_harness(**call.options) as harness:
        harness.autopilot.arm(call.armed)
        if call.before:
            await call.before(harness)
        await asyncio.sleep(1.0)
        senders = harness.connection._host.engine.senders
        senders.systems, senders.conflict_of = {1}, lambda system: TwoSenders()
        harness.connection._host.discovery.conflicts[1] = harness.vehicle.address
        await asyncio.sleep(0.1)  # until what was under way has arrived
        harness.autopilot.received.clear()
        return await outcome(harness, call), harness.autopilot.received


def test_the_table_of_reading_calls_has_no_other_names():
    assert {call.name for call in CALLS} >= READING_NAMES


@pytest.mark.parametrize("call", ACTING, ids=call_name)
def test_a_call_that_acts_is_refused_and_names_both_senders(call):
    error, received = run_virtually(in_conflict(call))
    assert isinstance(error, SystemIdConflictError), error
    assert "10.0.0.1:14550" in str(error)
    assert "10.0.0.2:14550" in str(error)
    assert not [message for message in received if acts(message)]


@pytest.mark.parametrize("call", [call for call in CALLS if call.name in READING_NAMES], ids=call_name)
def test_a_call_that_reads_sends_nothing_that_acts(call):
    error, received = run_virtually(in_conflict(call))
    assert not isinstance(error, SystemIdConflictError)
    assert not [message for message in received if acts(message)]


async def health_in_conflict():
    async with scripted_harness() as harness:
        senders = harness.connection._host.engine.senders
        before = harness.vehicle.health
        harness.connection._host.discovery.vehicle_conflict = lambda system: TwoSenders((1, 2))
        during = harness.vehicle.health
        senders.chosen = lambda system: "udpin 10.0.0.1:14550"
        return before, during, harness.vehicle.health


def test_no_vehicle_is_ready_while_two_use_its_id_and_none_is_chosen():
    before, during, chosen = run_virtually(health_in_conflict())
    assert during.ready is False
    (problem,) = during.problems
    assert "2 vehicles use system id 1: one on udpin 10.0.0.1:14550" in str(problem)
    assert chosen == before != during
