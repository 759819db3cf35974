"""`mav radio` against a simulated pair, in virtual time."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.cli.main import main
from mavstack.cli.radio import command
from mavstack.radio import RadioPair, simulator
from mavstack.sim.virtual import run_virtually
from tests.radio.pairs import bench

DEVICE = "/dev/ttyUSB9"


@pytest.fixture
def pair(monkeypatch):
    """A pair that every command reaches, whatever device it names."""
    pair = RadioPair()

    def run(work):
        for radio in (pair.near, pair.far):  # each command has a clock of its own
            radio.ready_at = radio._busy_until = radio._last_input = float("-inf")

        async def beside():
            async with bench(pair) as table:
                monkeypatch.setattr(command, "SikModem", lambda url: _Borrowed(table.modem))
                return await work

        return run_virtually(beside())

    monkeypatch.setattr(asyncio, "run", run)
    return pair


class _Borrowed:
    def __init__(self, modem):
        self.modem = modem

    async def __aenter__(self):
        return self.modem

    async def __aexit__(self, *_):
        await self.modem.leave()


def test_show_both_ends(pair, capsys):
    pair.far.values[3] = 26
    assert main(["radio", "show", DEVICE, "--both"]) == 0
    out, err = capsys.readouterr()
    assert "local: SiK 2.2 on HM-TRP, 915 MHz" in out
    assert "S3   NETID" in out
    assert "the ends differ in NETID" in err
    assert not pair.near.in_command_mode
    assert main(["radio", "show", DEVICE, "--remote", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["remote"]["parameters"]["NETID"] == 26


def test_get(pair, capsys):
    assert main(["radio", "get", DEVICE, "netid", "TXPOWER"]) == 0
    assert capsys.readouterr().out == "NETID=25\nTXPOWER=20\n"
    assert main(["radio", "get", DEVICE, "NETIT"]) == 1
    assert "did you mean NETID?" in capsys.readouterr().err


def test_shared_parameters_are_set_at_both_ends_and_others_here(pair, capsys):
    assert main(["radio", "set", DEVICE, "NETID=42", "TXPOWER=11"]) == 0
    assert "remote: NETID: 25 → 42" in capsys.readouterr().out
    assert (pair.near.running[3], pair.far.running[3]) == (42, 42)
    assert (pair.near.running[4], pair.far.running[4]) == (11, 20)
    assert main(["radio", "set", DEVICE, "NETID=42", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"local": {}, "remote": {}}


def test_an_interrupted_change_is_finished(pair, capsys):
    async def main():
        async with bench(pair) as table:
            task = asyncio.ensure_future(command._change_both(table.modem, {"NETID": 42}, {"NETID": 42}))
            while pair.far.stored[3] != 42:  # noqa: ASYNC110 (the radio has no events)
                await asyncio.sleep(0.1)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task

    run_virtually(main())
    assert (pair.near.running[3], pair.far.running[3]) == (42, 42)
    assert "finishing the change first" in capsys.readouterr().err


def test_one_end_is_set_alone(pair, capsys):
    assert main(["radio", "set", DEVICE, "NETID=42", "--remote"]) == 0
    assert "hears the remote one no more" in capsys.readouterr().err
    assert (pair.near.stored[3], pair.far.stored[3]) == (25, 42)
    assert main(["radio", "set", DEVICE, "NETID=42", "--local"]) == 0
    assert pair.near.stored[3] == 42


@pytest.mark.parametrize("words", [["NETID"], ["NETID=x"], ["ECC=2"], ["FORMAT=1"], ["NETID=1", "netid=2"]])
def test_wrong_values_are_refused_before_the_radio_is_opened(pair, capsys, words):
    assert main(["radio", "set", DEVICE, *words]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not pair.near.boots


def test_values_of_the_factory(pair, capsys):
    for radio in (pair.near, pair.far):
        radio.set(NETID=42, TXPOWER=11)
    assert main(["radio", "reset", DEVICE, "--dry-run"]) == 0
    assert "local: TXPOWER: 11 → 20" in capsys.readouterr().out
    assert (pair.near.running[3], pair.near.boots) == (42, 0)
    assert main(["radio", "reset", DEVICE]) == 0
    assert (pair.near.running[3], pair.far.running[3]) == (25, 25)
    assert (pair.near.running[4], pair.far.running[4]) == (20, 11)
    assert main(["radio", "reset", DEVICE, "--both"]) == 0
    assert pair.far.running[4] == 20


def test_the_timing_of_both_ends(pair, capsys):
    assert main(["radio", "show", DEVICE, "--both", "--timing"]) == 0
    assert "timing of the remote radio: silence_period 65, tx_window_width 469" in capsys.readouterr().out
    assert main(["radio", "show", DEVICE, "--timing", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["timing"]["local"]["tx_window_width"] == 469


def test_save_and_load(pair, capsys, tmp_path):
    file = tmp_path / "boat.radio"
    assert main(["radio", "save", DEVICE, str(file)]) == 0
    text = file.read_text()
    assert text.startswith("# SiK 2.2 on HM-TRP, local radio\nSERIAL_SPEED=57\n")
    file.write_text(text.replace("NETID=25", "NETID=9"))
    assert main(["radio", "load", DEVICE, str(file), "--dry-run"]) == 0
    assert "local: NETID: 25 → 9" in capsys.readouterr().out
    assert pair.near.stored[3] == 25
    assert main(["radio", "load", DEVICE, str(file)]) == 0
    assert (pair.near.running[3], pair.far.running[3]) == (9, 9)


def test_rssi(pair, capsys):
    assert main(["radio", "rssi", DEVICE, "--count", "2"]) == 0
    assert capsys.readouterr().out.count("margin 67 dB") == 2
    assert main(["radio", "rssi", DEVICE, "--count", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["fade_margin_db"] == 67.4
    assert (pair.near.reports, pair.near.in_command_mode) == (False, False)


def test_a_silent_pair_fails_in_one_line(pair, capsys):
    pair.far.powered = False
    assert main(["radio", "set", DEVICE, "NETID=4"]) == 1
    assert "nothing was changed" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["show"], ["show", "--both"], ["get", "NETID"], ["set", "NETID=4"], ["reset"]]
)
def test_texts_of_a_radio_do_not_control_the_terminal(pair, capsys, monkeypatch, words):
    monkeypatch.setattr(simulator, "BANNER", "SiK \x1b[2J\x9b5n\x07 2.2")
    assert main(["radio", words[0], DEVICE, *words[1:]]) in (0, 1)
    out, err = capsys.readouterr()
    assert out + err
    assert not {letter for letter in out + err if not letter.isprintable()} - {"\n", "\t"}
