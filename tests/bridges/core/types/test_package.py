"""The sources of ROS packages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.core.types.package import write_package
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from pathlib import Path


def test_actions_of_mavstack(tmp_path: Path) -> None:
    folder = write_package("mavstack_msgs", tmp_path)
    assert (folder / "action" / "Takeoff.action").read_text("utf-8").startswith("float64 altitude\n---\n")
    cmake = (folder / "CMakeLists.txt").read_text("utf-8")
    assert '"action/Goto.action"' in cmake
    assert "find_package(action_msgs REQUIRED)" in cmake
    assert "<depend>action_msgs</depend>" in (folder / "package.xml").read_text("utf-8")


def test_an_unknown_package(tmp_path: Path) -> None:
    with pytest.raises(InvalidArgumentError, match="package must be one of action_msgs"):
        write_package("../nonsense", tmp_path)
