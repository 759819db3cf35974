"""Status texts of a vehicle with their times."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.vehicle.telemetry.status_texts import MAX_TEXTS
from tests.vehicle.telemetry.harness import with_telemetry


def test_texts_with_time_severity_and_component():
    async def scenario(harness):
        begun = harness.node.now()
        harness.receive(common.Statustext(severity=4, text="Low battery"))
        await asyncio.sleep(10)
        harness.receive(common.Statustext(severity=200, text="odd"), component=100)
        first, second = harness.vehicle.status_texts
        assert (first.text, first.severity, first.component) == ("Low battery", common.MavSeverity.WARNING, 1)
        assert isinstance(first.severity, common.MavSeverity)
        assert first.time == pytest.approx(begun)
        assert (second.text, second.severity, second.component) == ("odd", 200, 100)
        assert [text.text for text in harness.telemetry.status_texts.since(begun + 5)] == ["odd"]

    with_telemetry(scenario)


def test_long_texts_are_joined_and_missing_chunks_marked():
    async def scenario(harness):
        harness.receive(common.Statustext(text="x" * 50, id=7, chunk_seq=0))
        harness.receive(common.Statustext(text="yz", id=7, chunk_seq=1))
        assert [text.text for text in harness.vehicle.status_texts] == ["x" * 50 + "yz"]
        harness.receive(common.Statustext(text="w" * 50, id=8, chunk_seq=0))
        assert len(harness.vehicle.status_texts) == 1
        await asyncio.sleep(5)
        assert harness.vehicle.status_texts[-1].text == "w" * 50 + "[...]"

    with_telemetry(scenario)


def test_a_limited_number_is_kept_of_this_vehicle_only():
    async def scenario(harness):
        for number in range(MAX_TEXTS + 50):
            await asyncio.sleep(1)
            harness.receive(common.Statustext(text=f"text {number}"))
            harness.receive(common.Statustext(text=f"other {number}"), system=2)
        texts = harness.vehicle.status_texts
        assert len(texts) == MAX_TEXTS
        assert texts[-1].text == f"text {MAX_TEXTS + 49}"
        assert texts[0].text == "text 50"

    with_telemetry(scenario)
