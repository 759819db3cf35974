"""`mav mission`, against simulated vehicles in virtual time and against one that misbehaves."""

from __future__ import annotations

import json
import shlex
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.cli.mission import command, show, transfer
from mavstack.dialects import common
from mavstack.files.plans import parse_plan, read_plan
from mavstack.links import MemoryNetwork
from mavstack.services import Address
from mavstack.services.mission import MissionServer, Plan, PlanStore, PlanType
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import run_until
from mavstack.sim.simulation import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.files.plans.plans import FENCE, FLIGHT, RALLY, WAYPOINTS
from tests.sim.harness import reduce_telemetry

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]

_RESULT = common.MavMissionResult


#: Up, a little way to the north, and down.
HOP = """\
QGC WPL 110
0 1 0 16 0 0 0 0 47.3977419 8.5455939 488 1
1 0 3 22 0 0 0 0 0 0 6 1
2 0 3 16 0 0 0 0 47.3978 8.5455939 6 1
3 0 3 21 0 0 0 0 47.3978 8.5455939 0 1
"""


class Field:
    """A simulated vehicle that one command after the other is run against."""

    def __init__(self, firmware: str) -> None:
        self.simulation = Simulation(seed=3)
        self.vehicle = self.simulation.add("copter", firmware)
        reduce_telemetry(self.vehicle)
        run_until(self.simulation, lambda: self.vehicle.autopilot.booted)
        self.simulation.advance(self.simulation.now + 20.0)
        self.vehicle.data_to_send()

    def run_on_vehicle(self, arguments: Namespace, work: Work) -> int:
        return run_virtually(self._run(arguments, work))

    async def _run(self, arguments: Namespace, work: Work) -> int:
        network = MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(network.link(), [self.vehicle])
            running = runner.start()
            async with connect(network.link()) as node:
                code = await work(await node.wait_for_vehicle(arguments.system, timeout=arguments.timeout))
            if running.done():
                running.result()
        return code


def use(monkeypatch: pytest.MonkeyPatch, run_on_vehicle: Callable[[Namespace, Work], int]) -> None:
    monkeypatch.setattr(transfer, "run_on_vehicle", run_on_vehicle)
    monkeypatch.setattr(show, "run_on_vehicle", run_on_vehicle)


@pytest.fixture(params=["ardupilot", "px4"])
def field(request, monkeypatch) -> Field:
    here = Field(request.param)
    use(monkeypatch, here.run_on_vehicle)
    return here


@pytest.fixture
def copter(monkeypatch) -> Field:
    here = Field("ardupilot")
    use(monkeypatch, here.run_on_vehicle)
    return here


@pytest.fixture(autouse=True)
def files(tmp_path, monkeypatch) -> Path:
    (tmp_path / "flight.plan").write_text(FLIGHT)
    (tmp_path / "flight.waypoints").write_text(WAYPOINTS)
    (tmp_path / "hop.waypoints").write_text(HOP)
    (tmp_path / "area.fen").write_text(FENCE)
    (tmp_path / "places.rally").write_text(RALLY)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.fast_cases(1)
def test_uploaded_plans_are_downloaded_equal(mav, field):
    result = mav("mission", "upload", "flight.plan", "--verify")
    assert (result.code, result.err) == (0, "")
    assert result.out.splitlines() == [
        "vehicle 1: fence: 6 items uploaded and verified",
        "vehicle 1: rally points: 2 items uploaded and verified",
        "vehicle 1: mission: 5 items uploaded and verified",
    ]
    result = mav("mission", "download", "back.plan")
    assert (result.code, result.err) == (0, "")
    assert result.out == "back.plan: mission: 5 items, fence: 6 items, rally points: 2 items\n"
    given, got = read_plan("flight.plan"), read_plan("back.plan")
    assert len(got.mission) == 5
    assert got.mission.items[3] == given.mission.items[3]  # the jump
    assert [item.name for item in got.mission.items] == [item.name for item in given.mission.items]
    assert got.home is not None
    assert got.home.latitude == pytest.approx(47.3977, abs=1e-3)
    assert got.settings.vehicle_type == common.MavType.QUADROTOR


@pytest.mark.fast_cases(1)
def test_jump_targets_follow_the_numbering_of_the_vehicle(mav, field):
    assert (
        mav("mission", "upload", "flight.plan", "--mission").out == "vehicle 1: mission: 5 items uploaded\n"
    )
    held = field.vehicle.plans.get(PlanType.MISSION)
    jump = next(item for item in held.items if item.command == common.MavCmd.DO_JUMP)
    target = held.items[int(jump.param1)]
    assert (target.command, target.param1) == (common.MavCmd.NAV_WAYPOINT, 3)  # the one with a hold of 3 s


@pytest.mark.flight
def test_standard_output_has_the_default_format(mav, copter):
    assert mav("mission", "upload", "flight.plan").code == 0
    result = mav("mission", "download")
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith("QGC WPL 110\n0\t1\t0\t16\t")
    assert len(parse_plan(result.out).mission) == 5
    result = mav("mission", "download", "--rally", "--format", "rally")
    assert result.out == "RALLY 47.396 8.544 25 0 0 0\nRALLY 47.395 8.545 15.5 0 0 0\n"


@pytest.mark.flight
def test_lossy_format_needs_force(mav, copter, files):
    assert mav("mission", "upload", "flight.plan", "--fence").code == 0
    result = mav("mission", "download", "back.fen")
    assert (result.code, result.out) == (1, "")
    assert result.err.count("\n") == 1
    assert result.err.startswith("mav mission: back.fen: the format 'fence' cannot hold circles (1)")
    assert not (files / "back.fen").exists()
    result = mav("mission", "download", "back.fen", "--force")
    assert result.code == 0
    assert "note: circles (1)" in result.err
    assert len(read_plan("back.fen").fence) == 5


@pytest.mark.flight
def test_json_output_can_be_uploaded(mav, copter, files):
    mav("mission", "upload", "flight.plan")
    shown = mav("mission", "show", "--json")
    assert (shown.code, shown.err) == (0, "")
    assert json.loads(shown.out)["problems"] == []
    (files / "shown.json").write_text(shown.out)
    assert (
        mav("mission", "clear", "--all-plans").out
        == "vehicle 1: fence: cleared\nvehicle 1: rally points: cleared\nvehicle 1: mission: cleared\n"
    )
    assert json.loads(mav("mission", "show", "--json").out)["mission"] == []
    assert mav("mission", "upload", "shown.json", "--verify").code == 0
    again = json.loads(mav("mission", "show", "--json").out)
    assert [again[key] for key in ("mission", "fence", "rally")] == [
        json.loads(shown.out)[key] for key in ("mission", "fence", "rally")
    ]


@pytest.mark.fast_cases(1)
def test_start_and_wait_for_completion(mav, field):
    mav("mission", "upload", "hop.waypoints")
    result = mav("mission", "start", "--wait")
    assert (result.code, result.out, result.err) == (0, "vehicle 1: mission: complete\n", "")
    assert field.vehicle.body.truth.north == pytest.approx(6.5, abs=1.5)
    assert field.vehicle.body.on_ground


@pytest.mark.fast_cases(1)
def test_start(mav, field):
    mav("mission", "upload", "flight.waypoints")
    result = mav("mission", "start")
    assert (result.code, result.out, result.err) == (0, "vehicle 1: mission: started\n", "")
    assert field.vehicle.autopilot.armed


@pytest.mark.fast_cases(1)
def test_start_without_a_mission_does_not_arm(mav, field):
    for words in (("start",), ("start", "--wait")):
        result = mav("mission", *words)
        assert (result.code, result.out) == (1, "")
        assert (
            result.err == "mav mission: vehicle 1 has no mission; upload one with `mav mission upload FILE`\n"
        )
        assert not field.vehicle.autopilot.armed


@pytest.mark.flight
def test_clear_deletes_only_the_mission(mav, copter):
    mav("mission", "upload", "flight.plan")
    assert mav("mission", "clear").out == "vehicle 1: mission: cleared\n"
    shown = json.loads(mav("mission", "show", "--json").out)
    assert [len(shown[key]) for key in ("mission", "fence", "rally")] == [0, 6, 2]


# Files


def test_show_as_table_and_map(mav):
    result = mav("mission", "show", "flight.plan")
    assert (result.code, result.err) == (0, "")
    lines = result.out.splitlines()
    assert lines[0] == "flight.plan: a mission of 5 items, 231 m; a fence of 2 areas; 2 rally points"
    assert lines[2].split() == ["#", "command", "place", "altitude", "distance", "params"]
    table = [line.split("  ") for line in lines[3:9]]
    assert [[word.strip() for word in row if word.strip()] for row in table] == [
        ["0", "home", "47.3977419 8.5455939", "488 m above sea"],
        ["1", "NAV_TAKEOFF", "here", "20 m above home"],
        ["2", "NAV_WAYPOINT", "47.3980000 8.5460000", "30 m above home", "42 m", "Hold 3 s"],
        ["3", "NAV_WAYPOINT", "47.3985000 8.5450000", "520.25 m above sea", "94 m", "Yaw 90°, stops here"],
        ["4", "DO_JUMP", "to 2, Repeat 3"],
        ["5", "NAV_RETURN_TO_LAUNCH", "95 m"],
    ]
    assert "stay inside the polygon of 4 vertices" in lines
    assert "stay outside the circle of 25.5 m around 47.3990000 8.5490000" in lines
    assert "return to 47.3977000 8.5456000, 30 m" in lines
    assert "north is up" in lines[-1]
    sketch = "\n".join(lines[-19:])
    assert "H" in sketch
    assert "3" in sketch
    without = mav("mission", "show", "flight.plan", "--no-map").out
    assert result.out.startswith(without)
    assert "north is up" not in without


def test_show_problems(mav, files):
    (files / "bad.plan").write_text(FLIGHT.replace("47.3980", "147.3980").replace("[2, 3,", "[9, 3,"))
    result = mav("mission", "show", "bad.plan", "--no-map")
    assert result.code == 0
    assert result.out.splitlines()[-3:] == [
        "problem: item 4 jumps to doJumpId 9, which no item has",
        "problem: mission item 2: NAV_WAYPOINT: latitude 147.398 is not between -90 and 90",
        "problem: mission item 4: DO_JUMP: it jumps to item 0, but the mission's items are 1 to 5",
    ]


def test_show_as_json(mav):
    shown = json.loads(mav("mission", "show", "flight.plan", "--json").out)
    assert shown["home"] == {"latitude": 47.3977419, "longitude": 8.5455939, "altitude": 488}
    assert [item["name"] for item in shown["mission"]][3:] == ["DO_JUMP", "NAV_RETURN_TO_LAUNCH"]
    assert shown["mission"][3]["params"][:2] == [1, 3]
    assert shown["mission"][1]["distance_m"] == pytest.approx(42, abs=1)
    assert shown["length_m"] == pytest.approx(
        sum(item["distance_m"] or 0 for item in shown["mission"]), abs=0.1
    )
    assert (len(shown["fence"]), len(shown["rally"])) == (6, 2)


def test_map_of_many_items_is_legible(mav, files):
    rows = [f"{seq} 0 3 16 0 0 0 0 {47 + seq % 2 / 1000} {8 + seq / 1000} 20 1" for seq in range(1, 101)]
    (files / "many.txt").write_text("\n".join(["QGC WPL 110", "0 1 0 16 0 0 0 0 47 8 400 1", *rows]))
    sketch = mav("mission", "show", "many.txt").out.splitlines()[104:]
    words = " ".join(sketch[:-1])
    for number in ("H", "1", "50", "100"):
        assert number in words
    assert "47" not in words
    assert max(map(len, sketch)) <= 67


@pytest.mark.parametrize("name", ["flight.waypoints", "area.fen", "places.rally"])
def test_show_every_format(mav, name):
    result = mav("mission", "show", name)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(f"{name}: ")


def test_convert(mav, files):
    assert mav("mission", "convert", "flight.plan", "out.waypoints", "--mission").code == 0
    assert read_plan("out.waypoints").mission == read_plan("flight.plan").mission
    assert mav("mission", "convert", "area.fen", "out.plan").code == 0
    assert len(read_plan("out.plan").fence) == 5
    assert mav("mission", "convert", "places.rally", "-").out.count("\t5100\t") == 2
    result = mav("mission", "convert", "flight.plan", "out.txt")
    assert result.code == 1
    assert result.err == (
        "mav mission: out.txt: the format 'waypoints' cannot hold the fence, as this format holds one "
        "type of plan (and 1 more); --force writes the rest, .json holds everything\n"
    )
    assert not (files / "out.txt").exists()


@pytest.mark.flight
def test_unsupported_pattern_is_refused(mav, copter, files):
    pattern = '{"type": "ComplexItem", "complexItemType": "StructureScan", "version": 3}, '
    (files / "scan.plan").write_text(FLIGHT.replace('"items": [', f'"items": [{pattern}'))
    for words in (("convert", "scan.plan", "out.json"), ("upload", "scan.plan")):
        result = mav("mission", *words)
        assert (result.code, result.out) == (1, "")
        assert result.err.startswith(
            "mav mission: scan.plan: mission.items[0]: the StructureScan was not read"
        )
        assert result.err.count("\n") == 1
    assert mav("mission", "convert", "scan.plan", "out.json", "--force").code == 0
    assert mav("mission", "upload", "scan.plan", "--force").code == 0


@pytest.mark.flight
def test_invalid_plan_is_not_uploaded(mav, copter, files):
    (files / "bad.plan").write_text(FLIGHT.replace("47.3980", "147.3980").replace("8.5450", "908.5450"))
    result = mav("mission", "upload", "bad.plan")
    assert (result.code, result.out) == (1, "")
    assert result.err == (
        "mav mission: bad.plan: mission item 2: NAV_WAYPOINT: latitude 147.398 is not between -90 and 90 "
        "(and 1 more); `mav mission show bad.plan` shows all problems, --force uploads the plan\n"
    )
    result = mav("mission", "upload", "bad.plan", "--force")
    assert result.code == 1
    assert result.out == "vehicle 1: fence: 6 items uploaded\nvehicle 1: rally points: 2 items uploaded\n"
    assert "INVALID_PARAM" in result.err
    assert result.err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("show", "missing.plan"), "missing.plan: No such file or directory"),
        (("upload", "area.fen", "--mission"), "area.fen: it has no mission"),
        (("convert", "flight.plan", "flight.kml"), "flight.kml: its suffix names no format"),
        (("convert", "flight.waypoints", "x.rally"), "x.rally: this format holds rally points, and the plan"),
        (("convert", "flight.waypoints", "no/where.plan"), "no/where.plan: No such file or directory"),
    ],
)
def test_failures_are_one_line(mav, words, expected):
    result = mav("mission", *words)
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith(f"mav mission: {expected}")
    assert result.err.count("\n") == 1


@pytest.mark.parametrize("words", [(), ("fly",), ("upload",), ("convert", "a.plan"), ("show", "--fence=1")])
def test_wrong_usage(mav, words):
    assert mav("mission", *words).code == 2


# A vehicle that refuses, or says nothing


class RefusingVehicle:
    """A vehicle of a scripted mission service: it refuses what it is told to, or says nothing at all."""

    def __init__(self, refused: int | None, result: int, *, silent: bool = False) -> None:
        self.refused, self.result, self.silent = refused, result, silent

    def run_on_vehicle(self, arguments: Namespace, work: Work) -> int:
        return run_virtually(self._run(arguments, work))

    async def _run(self, arguments: Namespace, work: Work) -> int:
        network = MemoryNetwork()
        kind: dict[str, Any] = {"type": common.MavType.QUADROTOR, "autopilot": common.MavAutopilot.PX4}
        async with connect(network.link(), system=1, component=1, **kind) as peer:
            if not self.silent:
                here = Address(1, 1)
                peer.serve(MissionServer(here, PlanStore(), validate=self._validate))
            async with connect(network.link()) as node:
                return await work(await node.wait_for_vehicle(arguments.system, timeout=arguments.timeout))

    def _validate(self, plan: Plan, source: Address) -> int:
        return self.result if plan.type == self.refused else _RESULT.ACCEPTED


def test_refused_fence_stops_the_upload(mav, monkeypatch):
    use(monkeypatch, RefusingVehicle(PlanType.FENCE, _RESULT.NO_SPACE).run_on_vehicle)
    result = mav("mission", "upload", "flight.plan")
    assert result.code == 1
    assert result.out == "vehicle 1: rally points: not sent\nvehicle 1: mission: not sent\n"
    assert result.err.startswith("mav mission: uploading the fence to 1/1 failed: NO_SPACE")
    assert result.err.count("\n") == 1


def test_refused_mission_is_reported_after_uploaded_plans(mav, monkeypatch):
    use(monkeypatch, RefusingVehicle(PlanType.MISSION, _RESULT.UNSUPPORTED).run_on_vehicle)
    result = mav("mission", "upload", "flight.plan")
    assert (result.code, result.out) == (
        1,
        "vehicle 1: fence: 6 items uploaded\nvehicle 1: rally points: 2 items uploaded\n",
    )
    assert result.err.startswith("mav mission: uploading the mission to 1/1 failed: UNSUPPORTED")


def test_refused_clear(mav, monkeypatch):
    use(monkeypatch, RefusingVehicle(PlanType.RALLY, _RESULT.DENIED).run_on_vehicle)
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
    use(monkeypatch, RefusingVehicle(None, 0, silent=True).run_on_vehicle)
    result = mav("mission", *words)
    assert result.code == 1
    assert result.err.startswith(f"mav mission: {expected} 1/1 failed")
    assert "no answer" in result.err
    assert result.err.count("\n") == 1


def test_no_vehicle(mav):
    result = mav("mission", "show", "--url", "udpin://127.0.0.1:0", "--timeout", "0.1")
    assert (result.code, result.out) == (1, "")
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
    use(monkeypatch, ForgetfulVehicle(None, 0).run_on_vehicle)
    result = mav("mission", "upload", "area.fen", "--verify")
    assert result.code == 1
    assert result.out == "vehicle 1: fence: 5 items uploaded\n"
    assert "item 0 (NAV_FENCE_POLYGON_VERTEX_INCLUSION) differs: param 5 is 47.4001 instead" in result.err
    assert result.err.count("\n") == 1


EXAMPLES = [line.strip() for line in command.EXAMPLES.splitlines()[1:]]


@pytest.mark.flight
def test_examples_of_the_help_run(mav, copter, capsys):
    ran = 0
    for line in [EXAMPLES[0], *EXAMPLES]:
        if line == "mav mission start":  # they have cleared it before
            mav("mission", "upload", "hop.waypoints")
        words = shlex.split(line.partition(" > ")[0])
        result = mav(*words[1:])
        assert (result.code, line) == (0, line), result.err
        ran += 1
    assert ran == len(EXAMPLES) + 1


@pytest.mark.parametrize("action", ["upload", "download", "clear", "start", "show", "convert"])
def test_each_help_page_has_examples(mav, action):
    page = mav("mission", action, "--help")
    assert page.code == 0
    assert f"  mav mission {action}" in page.out
