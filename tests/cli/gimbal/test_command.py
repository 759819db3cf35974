"""`mav gimbal` with a simulated vehicle."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.gimbal.command import EXAMPLES
from mavstack.cli.main import main
from mavstack.dialects import common
from tests.cli.harness import PX4_COPTER, CliHarness, examples_of


@pytest.fixture
def harness(monkeypatch):
    return CliHarness(monkeypatch, PX4_COPTER, payloads=True)


def mav(capsys, *words, code=0):
    """Run a command, and return its output."""
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def test_information(harness, capsys):
    text = mav(capsys, "gimbal", "info").out
    for part in ("1, managed by 1/1, Mavstack Simulated gimbal", "-90 to 30 degrees", "no component"):
        assert part in text
    (found,) = json.loads(mav(capsys, "gimbal", "info", "--json").out)
    assert found["manager"] == "1/1"
    assert found["attitude"]["pitch"] == pytest.approx(0, abs=0.1)


def test_movements(harness, capsys):
    assert "pitch -4" in mav(capsys, "gimbal", "point", "-45", "30").out
    text = mav(capsys, "gimbal", "point", "-20", "90", "--lock").out
    assert "yaw locked" in text
    assert mav(capsys, "gimbal", "point", "-45", "--no-wait").out == "vehicle 1: accepted\n"
    assert mav(capsys, "gimbal", "turn", "0", "15").out == "vehicle 1: turning\n"
    assert mav(capsys, "gimbal", "turn", "0", "0").out == "vehicle 1: stopped\n"
    mav(capsys, "gimbal", "center")
    mav(capsys, "gimbal", "retract")
    assert "looking at 47.5, 8.5, 0 m" in mav(capsys, "gimbal", "roi", "47.5", "8.5").out
    mav(capsys, "gimbal", "roi", "off")
    lines = mav(capsys, "gimbal", "watch", "--for", "2").out.splitlines()
    assert len(lines) == 4
    assert json.loads(mav(capsys, "gimbal", "release", "--json").out)["text"] == "control released"
    stuck = mav(capsys, "gimbal", "point", "80", code=1).err
    assert "no progress for 5 s" in stuck


def test_another_component_in_control(harness, capsys):
    async def pilot(autopilot):
        await autopilot.command(common.MavCmd.DO_GIMBAL_MANAGER_CONFIGURE, -2, -2, -1, -1)

    harness.meanwhile = pilot
    mav(capsys, "gimbal", "info")
    harness.meanwhile = None
    refused = mav(capsys, "gimbal", "point", "-10", code=1).err
    assert "component 254/190 is in control; add --take to take it over" in refused
    mav(capsys, "gimbal", "point", "-10", "--take")
    assert "255/190" in mav(capsys, "gimbal", "info", "--gimbal", "1").out
    assert "no gimbal 4; its gimbals: 1" in mav(capsys, "gimbal", "center", "--gimbal", "4", code=2).err


def test_a_vehicle_without_a_gimbal(monkeypatch, capsys):
    CliHarness(monkeypatch, PX4_COPTER)
    assert "vehicle 1 has no gimbal: no component manages one" in mav(capsys, "gimbal", "info", code=1).err


def test_wrong_usage(harness, capsys):
    assert "roi takes LAT LON [ALT]" in mav(capsys, "gimbal", "roi", "here", code=2).err


@pytest.mark.flight
def test_examples_of_the_help_run(harness, capsys):
    for words in examples_of(EXAMPLES):
        if words[1] == "follow":  # simulated vehicles do not receive positions of others
            assert "UNSUPPORTED" in mav(capsys, *words, code=1).err
        else:
            assert mav(capsys, *words).out, words
