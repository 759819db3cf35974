"""A mode has one name in every output of the commands, on each firmware and vehicle type."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.shell.completion import complete
from mavstack.cli.shell.runner import run_line
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.cli.harness import CliHarness
from tests.cli.shell.shell_session import in_shell

KINDS = [(vehicle_type, firmware) for firmware in Firmware for vehicle_type in VehicleType]


def test_lists_refusals_and_the_current_mode_have_the_same_names(mav, monkeypatch):
    CliHarness(monkeypatch, *KINDS)
    listed = [json.loads(line) for line in mav("vehicle", "modes", "--all", "--json").out.splitlines()]
    refused = [
        json.loads(line) for line in mav("vehicle", "mode", "nonsense", "--all", "--json").out.splitlines()
    ]
    refusals = {each["system"]: each["error"] for each in refused}
    assert len(listed) == len(refusals) == len(KINDS)
    for each in listed:
        names = [mode["name"] for mode in each["modes"]]
        selectable = [mode["name"] for mode in each["modes"] if mode["selectable"]]
        assert all(names)
        assert len(set(names)) == len(names)
        assert each["mode"] in names
        listed = refusals[each["system"]].partition("the vehicle has ")[2].split(", ")
        assert set(selectable) <= set(listed) <= set(names), KINDS[each["system"] - 1]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: f"{kind[1]}-{kind[0]}")
def test_the_shell_lists_and_completes_the_same_names(kind, capsys):
    async def scenario(session, world):
        candidates, _ = await complete(session, "mode ")
        await run_line(session, "mode")
        listed = {line[2:] for line in capsys.readouterr().out.splitlines()}
        assert {each.lower() for each in listed} == set(candidates)
        assert session.vehicle.mode in listed
        assert set(candidates) <= set((await complete(session, ""))[0]), "a mode is a command too"

    in_shell(kind, scenario)


def test_numbers_without_a_use_are_left_out(simulate, mav, monkeypatch):
    simulate((VehicleType.COPTER, Firmware.PX4))

    async def older(self, *, timeout=None):
        return self._documented_modes()  # the firmware does not list its modes

    monkeypatch.setattr("mavstack.node.modes.Modes.list", older)
    names = [line[2:].split()[0] for line in mav("vehicle", "modes").out.splitlines()]
    assert {"LOITER", "MISSION", "OFFBOARD", "TERMINATION"} <= set(names)
    assert not {"AUTO", "READY", "RATTITUDE", "SIMPLE", "EXTERNAL1", "EXTERNAL8"} & set(names)
