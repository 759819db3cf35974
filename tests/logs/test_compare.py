"""Differences between logs."""

from __future__ import annotations

import numpy as np

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.compare import (
    Difference,
    last_parameters,
    mission_differences,
    mission_of,
    parameter_differences,
)
from tests.logs.files import encoded, stamped
from tests.logs.memory_log import MemoryLog


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


def test_missions_and_parameters_of_two_vehicles_are_kept_apart(tmp_path):
    packets = []
    for system in (1, 2):
        messages = [common.Heartbeat(type=2, autopilot=3)]
        messages += [common.ParamValue(param_id="A", param_value=system, param_type=9, param_count=1)]
        packets += encoded(messages, system=system)
    for target in (2, 1):
        item = common.MissionItemInt(seq=0, command=16, x=target, target_system=target)
        packets += encoded([item], system=255)
    (tmp_path / "two").write_bytes(stamped(packets))
    log = open_log(tmp_path / "two", "common")
    assert [mission_of(log, system)[0][6] for system in (None, 1, 2)] == [1, 1, 2]
    assert [last_parameters(log, system) for system in (None, 1, 2)] == [{"A": 1.0}, {"A": 1.0}, {"A": 2.0}]
    assert mission_differences(log, log, system=2) == parameter_differences(log, log, system=2) == []


def test_vehicles_with_items_in_different_messages(tmp_path):
    beat = common.Heartbeat(autopilot=3)
    beats = [packet for system in (1, 2) for packet in encoded([beat], system=system)]
    items = [
        common.MissionItemInt(seq=0, command=16, x=1, target_system=1),
        common.MissionItem(seq=0, command=21, x=2, target_system=2),
    ]
    (tmp_path / "two").write_bytes(stamped(beats + encoded(items, system=255)))
    log = open_log(tmp_path / "two", "common")
    assert [mission_of(log, system)[0][0] for system in (1, 2)] == [16, 21]


def test_the_flown_items_of_a_ulog():
    columns = {
        "TimeUS": [1, 2, 3, 4, 5],
        "instance_count": [1, 2, 2, 2, 2],
        "sequence_current": [7, 0, 0, 1, 1],
        "nav_cmd": [16, 22, 22, 16, 16],
        "nav_sub_cmd": [0, 0, 1, 1, 0],
        "latitude": np.array([1, 2, 3, 4, 5], np.float32),
    }
    log = MemoryLog({"navigator_mission_item": columns})
    assert mission_of(log) == {0: (22, 2), 1: (16, 5)}, "of the last mission, without steps in between"


def test_the_items_of_an_onboard_log():
    columns = {"TimeUS": [1, 2], "CNum": [0, 1], "CId": [16, 21], "Lat": [47.0, 48.0]}
    assert mission_of(MemoryLog({"CMD": columns})) == {0: (16, 47.0), 1: (21, 48.0)}
