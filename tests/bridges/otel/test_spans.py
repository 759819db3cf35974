"""Spans of the operations of a simulated vehicle: names, attempts, repetitions, results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from mavstack.errors import CommandDenied, MavstackError
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ARDUPILOT, World, fly

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

pytest.importorskip("opentelemetry.sdk.trace")
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import SimpleSpanProcessor
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter

from mavstack.bridges.otel.spans import OperationSpans

COPTER = (VehicleType.COPTER, ARDUPILOT)


def spans_of(scenario: Any, **conditions: Any) -> list[Any]:
    """The spans of a scenario."""
    memory = InMemorySpanExporter()
    provider = TracerProvider()
    provider.add_span_processor(SimpleSpanProcessor(memory))

    async def traced(world: World, vehicle: Vehicle) -> None:
        async with OperationSpans(world.node, provider.get_tracer("test")):
            await scenario(vehicle)

    fly(COPTER, traced, **conditions)
    return list(memory.get_finished_spans())


def test_an_upload_and_a_parameter_have_spans() -> None:
    async def scenario(vehicle: Vehicle) -> None:
        await vehicle.mission.upload([MissionItem(16, param5=47.3977, param6=8.5456, param7=10.0)])
        await vehicle.params.get("RTL_ALT")

    found = spans_of(scenario)
    names = [span.name for span in found]
    upload = next(span for span in found if "upload" in span.name)
    assert upload.attributes["mavlink.target.system"] == 1
    assert upload.end_time >= upload.start_time > 0
    assert upload.status.is_unset
    assert any("RTL_ALT" in name for name in names)


def test_a_refusal_is_an_error_with_the_result() -> None:
    async def scenario(vehicle: Vehicle) -> None:
        with pytest.raises(CommandDenied):
            await vehicle.arm(keep_mode=True)

    found = [span for span in spans_of(scenario, ready=False) if not span.status.is_ok]
    errors = [span for span in found if span.attributes.get("error.type")]
    assert errors[-1].attributes["error.type"] == "CommandDenied"
    assert errors[-1].attributes["mavlink.result"] == "FAILED"


def test_repetitions_are_events() -> None:
    async def scenario(vehicle: Vehicle) -> None:
        for _ in range(12):
            try:
                await vehicle.params.get("RTL_ALT")
            except MavstackError:
                continue

    retried = [span for span in spans_of(scenario, loss=0.4) if span.events]
    assert retried
    for span in retried:
        assert [event.name for event in span.events] == ["retry"] * len(span.events)
        times = [event.timestamp for event in span.events]
        assert span.start_time <= times[0] <= times[-1] <= span.end_time
        assert span.attributes["mavlink.attempts"] > 1
