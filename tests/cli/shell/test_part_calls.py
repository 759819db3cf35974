"""The command `call` lists and runs the calls of services without a command, and explains wrong words."""

from __future__ import annotations

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.runner import run_line
from tests.cli.shell.shell_session import COPTER, in_shell


def test_calls(capsys):
    async def scenario(session, world):
        await run_line(session, "call; call terrain check 47.3977 8.5456")
        with pytest.raises(UsageError, match="there is no call 'terrain fly'"):
            await run_line(session, "call terrain fly")
        with pytest.raises(UsageError, match="usage: call terrain check LATITUDE LONGITUDE"):
            await run_line(session, "call terrain check 1 2 3")

    in_shell(COPTER, scenario)
    out = capsys.readouterr().out
    assert "terrain check LATITUDE LONGITUDE: Ask for the terrain" in out
    assert "latitude: 47.3977\n" in out
