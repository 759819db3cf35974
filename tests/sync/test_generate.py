"""The stub of the blocking API is up to date, and type checkers read blocking types from it."""

from __future__ import annotations

import ast
import subprocess
import sys
from typing import TYPE_CHECKING

from mavstack.sync import generate
from tests.type_checkers import run_mypy

if TYPE_CHECKING:
    from pathlib import Path

#: Classes of the node and the vehicle that have no blocking counterpart: values and options.
VALUES = {
    "mavstack.node.channel_state.ChannelState",
    "mavstack.vehicle.following.follow.Level",
    "mavstack.vehicle.following.radio.FollowOptions",
    "mavstack.vehicle.actions.renumber.Renumbered",
    "mavstack.vehicle.calibration.kinds.CalibrationKind",
    "mavstack.vehicle.calibration.kinds.CalibrationResult",
    "mavstack.vehicle.calibration.kinds.CalibrationStep",
    "mavstack.vehicle.capabilities.Capabilities",
    "mavstack.vehicle.connection.NodeOptions",
    "mavstack.vehicle.external.diagnosis.ExternalStatus",
    "mavstack.vehicle.health.Health",
    "mavstack.vehicle.rtk.rtk.RtkStatus",
    "mavstack.vehicle.swarm.controller.SwarmOptions",
    "mavstack.vehicle.telemetry.surroundings.Distance",
    "mavstack.vehicle.telemetry.surroundings.Obstacles",
    "mavstack.vehicle.telemetry.values",
    "mavstack.vehicle.telemetry.values.HomePosition",
    "mavstack.vehicle.telemetry.values.Position",
    "mavstack.vehicle.transponder.TransponderStatus",
    "mavstack.vehicle.vehicle_type.VehicleType",
}

PROGRAM = """
from mavstack.dialects import common
from mavstack.sync import Node

with Node("udpin://0.0.0.0:14550") as node:
    vehicle = node.wait_for_autopilot(timeout=3)
    reveal_type(vehicle.command(common.MavCmd.NAV_LAND).attempts)
    for message in node.stream(common.Attitude):
        reveal_type(message.roll)
    node.wait_for_autopilot(5, limit=3)
"""


def test_the_stub_is_up_to_date() -> None:
    # In its own process: other tests import modules whose classes the generator would find too.
    command = [sys.executable, "-m", "mavstack.sync.generate", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr


def test_the_stub_shows_no_internal_class() -> None:
    tree = ast.parse(generate.STUB.read_text("utf-8"))
    imported = {
        f"{item.module}.{alias.name}"
        for item in tree.body
        if isinstance(item, ast.ImportFrom)
        for alias in item.names
        if str(item.module).startswith(("mavstack.node", "mavstack.vehicle"))
    }
    assert imported <= VALUES
    methods = {item.name for item in ast.walk(tree) if isinstance(item, ast.FunctionDef)}
    assert "__await__" not in methods
    assert not any(isinstance(item, ast.AsyncFunctionDef | ast.Await) for item in ast.walk(tree))


def test_type_checkers_see_blocking_calls(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    lines = run_mypy(str(program)).stdout.splitlines()
    assert [line.partition(": ")[2].partition("  [")[0] for line in lines] == [
        'note: Revealed type is "int"',
        'note: Revealed type is "float"',
        'error: Unexpected keyword argument "limit" for "wait_for_autopilot" of "Node"',
        'note: "wait_for_autopilot" defined in "mavstack.sync"',
    ], lines
