"""`mav msp` against a small flight controller, in virtual time."""

from __future__ import annotations

import io
import json
import sys

from mavstack.cli.common import stdin_lines
from mavstack.cli.main import main
from mavstack.cli.msp import console
from tests.bridges.msp.controllers import IDENTITY

DEVICE = "/dev/ttyACM9"
ATTACK = "\x1b[2J\x1b]0;x\x07"


def give_lines(monkeypatch, *lines: str) -> None:
    async def give():
        for line in lines:
            yield line

    monkeypatch.setattr(console, "stdin_lines", give)
    assert stdin_lines is not give


def test_info(firmware, capsys):
    assert main(["msp", "info", DEVICE]) == 0
    out = capsys.readouterr().out
    assert "firmware     Betaflight 4.5.1 (BTFL)\nMSP version  1.46\nboard        S405 STM32F405\n" in out
    assert main(["msp", "info", DEVICE, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["variant"], document["version"], document["api"]) == ("BTFL", "4.5.1", "1.46")
    assert firmware.restarts == 0


def test_errors_of_the_line(firmware, capsys):
    firmware.silent = True
    assert main(["msp", "info", DEVICE]) == 1
    assert "no answer; check the baud rate" in capsys.readouterr().err
    assert main(["msp", "info", "udpin://0.0.0.0:14550"]) == 2
    assert "carries no MSP" in capsys.readouterr().err
    assert main(["msp", "info", DEVICE, "--baud", "0"]) == 2


def test_lines_of_the_cli(firmware, capsys):
    assert main(["msp", "cli", DEVICE, "-c", "set gyro_hardware = MPU", "-c", ""]) == 0
    out, err = capsys.readouterr()
    assert (out, err) == ("gyro_hardware set to MPU\n", "the controller restarts …\n")
    assert (firmware.saved["gyro_hardware"], firmware.restarts) == ("AUTO", 1)
    assert main(["msp", "cli", DEVICE, "-c", "set gyro_hardware = MPU", "--save", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"set gyro_hardware = MPU": "gyro_hardware set to MPU"}
    assert firmware.saved["gyro_hardware"] == "MPU"


def test_a_line_with_an_error_ends_the_cli_without_saving(firmware, capsys):
    lines = ["-c", "set gyro_hardware = MPU", "-c", "set x = 1", "-c", "diff all"]
    assert main(["msp", "cli", DEVICE, *lines, "--save"]) == 1
    out, err = capsys.readouterr()
    assert out.endswith("###ERROR IN set: INVALID NAME###\n")
    assert "'set x = 1' failed: ERROR IN set: INVALID NAME; nothing was saved" in err
    assert firmware.saved["gyro_hardware"] == "AUTO"
    assert main(["msp", "cli", DEVICE, "-c", "what?"]) == 2


def test_the_cli_with_lines_of_standard_input(firmware, capsys, monkeypatch):
    give_lines(monkeypatch, "set gyro_hardware = MPU", "save", "never sent")
    assert main(["msp", "cli", DEVICE]) == 0
    assert capsys.readouterr().out == "gyro_hardware set to MPU\nRebooting\n"
    assert firmware.saved["gyro_hardware"] == "MPU"
    give_lines(monkeypatch, "set x = 1", "save")
    assert main(["msp", "cli", DEVICE]) == 1
    assert main(["msp", "cli", DEVICE, "--json"]) == 2


def test_the_cli_on_a_terminal(firmware, capsys, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    give_lines(monkeypatch, "get ?", "set x = 1", "set gyro_hardware = MPU")
    assert main(["msp", "cli", DEVICE, "--save"]) == 1  # the firmware refuses to save after an error
    out = capsys.readouterr().out
    assert out.startswith("# CLI line 'get ?' must be printable ASCII")
    assert out.endswith("# gyro_hardware set to MPU\n# \n")


def test_dump_and_restore(firmware, capsys, tmp_path):
    path = tmp_path / "quad.txt"
    assert main(["msp", "dump", DEVICE, "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"3 commands saved to {path}\n"
    assert main(["msp", "dump", DEVICE]) == 0
    assert capsys.readouterr().out == path.read_text()
    path.write_text(path.read_text().replace("AUTO", "MPU"))
    assert main(["msp", "restore", DEVICE, str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"file": str(path), "commands": 3}
    assert firmware.saved["gyro_hardware"] == "MPU"


def test_files_that_are_no_dumps(firmware, capsys, tmp_path):
    path = tmp_path / "quad.txt"
    assert main(["msp", "restore", DEVICE, str(path)]) == 1
    path.write_text("# nothing\nsave\n")
    assert main(["msp", "restore", DEVICE, str(path)]) == 1
    assert "it has no commands" in capsys.readouterr().err
    path.write_bytes(b"set a = \xff\n")
    assert main(["msp", "restore", DEVICE, str(path)]) == 1
    assert "it is no dump" in capsys.readouterr().err
    assert firmware.restarts == 0


def test_passthrough_to_a_port_that_is_not_there(firmware, capsys):
    firmware.replies = {**IDENTITY, 245: b"\0"}
    assert main(["msp", "passthrough", DEVICE, "--port", "uart4", "--out", "tcpin://127.0.0.1:0"]) == 1
    assert "connecting serial port 3 of" in capsys.readouterr().err
    assert main(["msp", "passthrough", DEVICE]) == 2


def test_texts_of_a_controller_do_not_reach_the_terminal_as_they_are(firmware, capsys, tmp_path):
    firmware.replies[10] = firmware.replies[2] = ATTACK.encode()
    firmware.settings["name"] = ATTACK
    assert main(["msp", "info", DEVICE]) == 0
    assert main(["msp", "dump", DEVICE]) == 0
    assert main(["msp", "cli", DEVICE, "-c", "diff all"]) == 0
    captured = capsys.readouterr()
    assert "set name" in captured.out
    assert "\x1b" not in captured.out + captured.err
    assert "\x07" not in captured.out + captured.err
