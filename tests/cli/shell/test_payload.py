"""The shell drives a camera and a gimbal, and asks before it erases a storage."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.shell.runner import run_line
from tests.cli.shell.shell_session import PX4_COPTER, in_shell


def test_camera_and_gimbal(capsys):
    async def scenario(session, world):
        await run_line(session, "camera photo; camera zoom 50; camera mode video; camera video start")
        await run_line(session, "gimbal point -45 30; gimbal release")
        with pytest.raises(UsageError, match="invalid choice: 'fly'"):
            await run_line(session, "camera fly")
        with pytest.raises(UsageError, match="no gimbal 4; its gimbals: 1"):
            await run_line(session, "gimbal center --gimbal 4")

    in_shell(PX4_COPTER, scenario, payloads=True)
    printed = capsys.readouterr().out
    for text in ("image 0", "zoom 50 %", "recording", "pitch -4", "control released"):
        assert text in printed


def test_erasing_a_storage_asks(capsys):
    async def scenario(session, world):
        answers = ["n", "y"]

        async def ask(question):
            assert question == "erase the storage of the camera of vehicle 1? [y/N] "
            return answers.pop(0)

        session.ask = ask
        with pytest.raises(CommandError, match="nothing was erased"):
            await run_line(session, "camera format")
        await run_line(session, "camera format")
        await run_line(session, "camera format --yes")
        assert answers == []

    in_shell(PX4_COPTER, scenario, payloads=True)
    assert capsys.readouterr().out.count("storage 1 erased") == 2


def test_a_vehicle_without_payloads():
    async def scenario(session, world):
        with pytest.raises(CommandError, match="vehicle 1 has no gimbal"):
            await run_line(session, "gimbal info")

    in_shell(PX4_COPTER, scenario)
