"""`mav rtk` with a simulated vehicle and a caster, over real sockets."""

from __future__ import annotations

import json

from mavstack.cli.main import main
from mavstack.sim import BackgroundSimulator
from tests.gnss.caster import caster


def mav(capsys, *words, code=0):
    """Run a command, and return its output."""
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def test_corrections_reach_the_vehicle(capsys):
    with caster() as server, BackgroundSimulator() as simulator:
        done = mav(capsys, "rtk", server.url, "--url", simulator.url, "--for", "3")
    assert f"receiving corrections from ntrip://127.0.0.1:{server.server_address[1]}/NEAR" in done.out
    assert "vehicle 1/1: RTK float" in done.out
    assert " frames received (" in done.out
    assert "secret" not in done.out + done.err


def test_counts_as_json(capsys):
    with caster() as server, BackgroundSimulator() as simulator:
        done = mav(capsys, "rtk", server.url, "--url", simulator.url, "--for", "1", "--json")
    counts = json.loads(done.out)["counts"]
    assert counts["frames"] > 3
    assert counts["sent"] > 3


def test_streams_of_a_caster(capsys):
    with caster() as server:
        assert mav(capsys, "rtk", server.url, "--list").out.splitlines()[1].split() == [
            "NEAR", "Zurich", "RTCM", "3.2", "GPS+GLO", "yes",
        ]  # fmt: skip
        bare = server.url.removesuffix("NEAR")
        assert json.loads(mav(capsys, "rtk", bare, "--json").out)[0]["mountpoint"] == "NEAR"


def test_a_wrong_password_fails_in_one_line(capsys):
    with caster() as server, BackgroundSimulator() as simulator:
        url = server.url.replace("secret", "wrong")
        done = mav(capsys, "rtk", url, "--url", simulator.url, code=1)
    assert done.err.splitlines()[-1].endswith("/NEAR failed: it refused user and password")


def test_wrong_usage(capsys):
    assert "ntrip://USER" in mav(capsys, "rtk", "ntrip://", code=2).err
    assert "--list needs" in mav(capsys, "rtk", "tcpout://localhost:1", "--list", code=2).err
    assert "not a caster" in mav(capsys, "rtk", "ntrip://a/b", "--survey-in", "60,2", code=2).err
    assert mav(capsys, "rtk", "serial:///dev/null", "--fixed", "1,2", code=2).err
