"""Differences between logs."""

from __future__ import annotations

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.compare import Difference, mission_differences, mission_of, parameter_differences
from tests.logs.files import encoded, stamped


def log_of(path, parameters, items):
    messages = [common.Heartbeat(type=2, autopilot=3)]
    messages += [
        common.ParamValue(param_id=name, param_value=value, param_type=9, param_count=2)
        for name, value in parameters
    ]
    messages += [
        common.MissionItemInt(seq=seq, command=command, x=x, param4=float("nan"), mission_type=kind)
        for seq, command, x, kind in items
    ]
    path.write_bytes(stamped(encoded(messages)))
    return open_log(path, "common")


def test_parameters_and_missions(tmp_path):
    first = log_of(tmp_path / "a", [("A", 1.0), ("B", 2.0), ("B", 3.0)], [(0, 16, 5, 0), (1, 22, 6, 0)])
    second = log_of(tmp_path / "b", [("B", 4.0), ("C", 1.0)], [(0, 16, 5, 0), (1, 21, 6, 0), (0, 5001, 1, 1)])
    assert parameter_differences(first, second) == [
        Difference("A", 1.0, None),
        Difference("B", 3.0, 4.0),
        Difference("C", None, 1.0),
    ]
    assert len(mission_of(second)) == 2, "a fence is no mission"
    (difference,) = mission_differences(first, second)
    assert difference.name == "item 1"
    assert str(difference.first).startswith("22 ")
    assert str(difference.second).startswith("21 ")
    assert parameter_differences(first, first) == mission_differences(second, second) == []


def test_the_last_transfer_of_a_mission_counts(tmp_path):
    log = log_of(tmp_path / "a", [], [(0, 16, 5, 0), (0, 16, 9, 0)])
    assert mission_of(log)[0][6] == 9
