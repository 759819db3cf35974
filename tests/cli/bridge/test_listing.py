"""`mav bridge list` and `mav bridge package`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from mavstack.bridges.core.table import ALL
from mavstack.cli.main import main

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_the_table_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bridge", "list", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert len(rows) == len(ALL)
    imu = next(row for row in rows if row["name"] == "imu/data")
    assert imu["type"] == "sensor_msgs/msg/Imu"
    assert imu["messages"] == ["ATTITUDE", "ATTITUDE_QUATERNION"]
    assert next(row for row in rows if row["name"] == "cmd/arming")["role"] == "operate"


def test_the_table_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bridge", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["NAME", "KIND", "TYPE", "MAVLINK"]
    assert len(lines) == len(ALL) + 2


def test_a_package_for_ros(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bridge", "package", "mavstack_msgs", str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "mavstack_msgs")
    assert main(["bridge", "package", "nonsense", str(tmp_path)]) == 1


def test_the_keys_of_a_fleet(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bridge", "list", "zenoh", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert rows[0]["key"] == "<prefix>/<vehicle>/frame/out"
    assert main(["bridge", "list", "zenoh"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(rows) + 1
