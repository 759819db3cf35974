"""`mav mission` with vehicles that refuse plans, lose them, or do not answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.services import Address
from mavstack.services.mission import MissionServer, Plan, PlanStore, PlanType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.cli.mission.harness import run_commands_on

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]

_RESULT = common.MavMissionResult


class RefusingVehicle:
    """A vehicle whose mission service refuses the plans that a test names, or does not answer."""

    def __init__(self, refused: int | None, result: int, *, silent: bool = False) -> None:
        self.refused, self.result, self.silent = refused, result, silent

    def run_on_vehicle(self, arguments: Namespace, work: Work) -> int:
        return run_virtually(self._run(arguments, work))

    async def _run(self, arguments: Namespace, work: Work) -> int:
        network = MemoryNetwork()
        kind: dict[str, Any] = {"type": common.MavType.QUADROTOR, "autopilot": common.MavAutopilot.PX4}
        async with connect(network.link(), system=1, component=1, **kind) as peer:
            if not self.silent:
                target = Address(1, 1)
                peer.serve(MissionServer(target, PlanStore(), validate=self._validate))
            async with connect(network.link()) as node:
                return await work(await node.wait_for_vehicle(arguments.system, timeout=arguments.timeout))

    def _validate(self, plan: Plan, source: Address) -> int:
        return self.result if plan.type == self.refused else _RESULT.ACCEPTED


def test_fence_that_the_firmware_has_not_does_not_keep_the_mission_from_being_sent(mav, monkeypatch):
    run_commands_on(monkeypatch, RefusingVehicle(PlanType.FENCE, _RESULT.UNSUPPORTED).run_on_vehicle)
    result = mav("mission", "upload", "flight.plan")
    assert result.code == 1
    first, *uploaded = result.out.splitlines()
    assert first == "vehicle 1: fence: not sent, the firmware has none"
    assert [line.partition(": ")[2].partition(":")[0] for line in uploaded] == ["rally points", "mission"]
    assert all(line.endswith("uploaded") for line in uploaded)
    assert (
        "vehicle 1 does not support the fence; sent without: the rally points and the mission" in result.err
    )
    assert "with --rally --mission the others are not tried" in result.err
    assert mav("mission", "upload", "flight.plan", "--rally", "--mission").code == 0
    named = mav("mission", "upload", "flight.plan", "--fence", "--mission")
    assert (named.code, named.out) == (1, "vehicle 1: mission: not sent\n")


def test_refused_fence_stops_the_upload(mav, monkeypatch):
    run_commands_on(monkeypatch, RefusingVehicle(PlanType.FENCE, _RESULT.NO_SPACE).run_on_vehicle)
    result = mav("mission", "upload", "flight.plan")
    assert result.code == 1
    assert result.out == "vehicle 1: rally points: not sent\nvehicle 1: mission: not sent\n"
    assert result.err.startswith("mav mission: uploading the fence to 1/1 failed: NO_SPACE")
    assert result.err.count("\n") == 1


def test_refused_mission_is_reported_after_uploaded_plans(mav, monkeypatch):
    run_commands_on(monkeypatch, RefusingVehicle(PlanType.MISSION, _RESULT.UNSUPPORTED).run_on_vehicle)
    result = mav("mission", "upload", "flight.plan")
    assert (result.code, result.out) == (
        1,
        "vehicle 1: fence: 6 items uploaded\nvehicle 1: rally points: 2 items uploaded\n",
    )
    assert result.err.startswith("mav mission: uploading the mission to 1/1 failed: UNSUPPORTED")


def test_refused_clear(mav, monkeypatch):
    run_commands_on(monkeypatch, RefusingVehicle(PlanType.RALLY, _RESULT.DENIED).run_on_vehicle)
    result = mav("mission", "clear", "--all-plans")
    assert (result.code, result.out) == (1, "vehicle 1: fence: cleared\nvehicle 1: mission: not cleared\n")
    assert result.err.startswith("mav mission: clearing the rally points on 1/1 failed: DENIED")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("upload", "flight.plan"), "uploading the fence to"),
        (("download", "flight.waypoints"), "downloading the mission from"),
        (("show",), "downloading the mission from"),
        (("clear",), "clearing the mission on"),
    ],
)
def test_silent_vehicle(mav, monkeypatch, words, expected):
    run_commands_on(monkeypatch, RefusingVehicle(None, 0, silent=True).run_on_vehicle)
    result = mav("mission", *words)
    assert result.code == 1
    assert result.err.startswith(f"mav mission: {expected} 1/1 failed")
    assert "no answer" in result.err
    assert result.err.count("\n") == 1


def test_verify_reports_a_difference(mav, monkeypatch):
    class ForgetfulVehicle(RefusingVehicle):
        def _validate(self, plan: Plan, source: Address) -> int:
            return _RESULT.ACCEPTED

    def rounded(store: PlanStore, plan: Plan) -> None:
        from dataclasses import replace

        items = (replace(plan.items[0], param5=plan.items[0].param5 + 1e-4), *plan.items[1:])
        kept(store, Plan.of(items, plan.type))

    kept = PlanStore.put
    monkeypatch.setattr(PlanStore, "put", rounded)
    run_commands_on(monkeypatch, ForgetfulVehicle(None, 0).run_on_vehicle)
    result = mav("mission", "upload", "area.fen", "--verify")
    assert result.code == 1
    assert result.out == "vehicle 1: fence: 5 items uploaded\n"
    assert "item 0 (NAV_FENCE_POLYGON_VERTEX_INCLUSION) differs: param 5 is 47.4001 instead" in result.err
    assert result.err.count("\n") == 1
