"""`mav camera` with a simulated vehicle."""

from __future__ import annotations

import json
import sys

import pytest

from mavstack.cli.camera.command import EXAMPLES
from mavstack.cli.main import main
from tests.cli.harness import PX4_COPTER, CliHarness, examples_of


@pytest.fixture
def harness(monkeypatch):
    return CliHarness(monkeypatch, PX4_COPTER, payloads=True)


def mav(capsys, *words, code=0):
    """Run a command, and return its output."""
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


def test_information(harness, capsys):
    text = mav(capsys, "camera", "info").out
    for part in ("Mavstack Simulated camera", "1/100", "5472 x 3648", "image, zoom 0 %", "4096 MiB free"):
        assert part in text
    assert "rtsp://127.0.0.1:8554/camera" in text
    found = json.loads(mav(capsys, "camera", "info", "--json").out)
    assert found["camera"] == "1/100"
    assert found["status"]["mode"] == "image"
    assert "tracking" in found["abilities"]
    assert mav(capsys, "camera", "list").out == "camera 100\n"
    assert json.loads(mav(capsys, "camera", "list", "--json").out) == [{"id": 100, "attached": False}]


def test_images(harness, capsys):
    """Each command is a program of its own, and still takes its own image."""
    assert "image 0: 47.3977" in mav(capsys, "camera", "photo").out
    assert json.loads(mav(capsys, "camera", "photo", "--json").out)["index"] == 1
    lines = mav(capsys, "camera", "photo", "--count", "3", "--interval", "0.5").out.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["image 2", "image 3", "image 4"]
    mav(capsys, "camera", "stop")


def test_actions(harness, capsys):
    refused = mav(capsys, "camera", "video", "start", code=1).err
    assert "VIDEO_START_CAPTURE on 1/100 failed: TEMPORARILY_REJECTED" in refused
    assert mav(capsys, "camera", "mode", "video").out == "vehicle 1: mode video\n"
    mav(capsys, "camera", "video", "start")
    mav(capsys, "camera", "video", "stop")
    mav(capsys, "camera", "stream", "stop", "1")
    assert "stopped" in mav(capsys, "camera", "info").out
    mav(capsys, "camera", "zoom", "50")
    mav(capsys, "camera", "focus", "auto")
    mav(capsys, "camera", "focus", "20")
    assert harness.vehicle.camera.device.zoom == 50
    mav(capsys, "camera", "track", "0.5", "0.5")
    mav(capsys, "camera", "track", "0.1", "0.1", "0.5", "0.5")
    assert harness.vehicle.camera.device.tracked.rectangle is not None
    mav(capsys, "camera", "track", "off")
    mav(capsys, "camera", "reset")
    outcome = json.loads(mav(capsys, "camera", "mode", "photo", "--json").out)
    assert (outcome["ok"], outcome["text"]) == (True, "mode photo")


def test_format(harness, capsys, monkeypatch):
    mav(capsys, "camera", "photo")
    assert "add --yes" in mav(capsys, "camera", "format", code=2).err
    assert mav(capsys, "camera", "format", "--yes").out == "vehicle 1: storage 1 erased\n"
    assert harness.vehicle.camera.device.used == 0.0
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    monkeypatch.setattr(sys.stdin, "readline", lambda: "n\n")
    assert "nothing was erased" in mav(capsys, "camera", "format", code=1).err


def test_settings(harness, capsys, tmp_path):
    text = mav(capsys, "camera", "settings").out
    assert "White balance" in text
    assert "(no effect now)" in text
    one = mav(capsys, "camera", "settings", "cam_wbmode").out
    assert one == "CAM_WBMODE: Auto\noptions: Auto, Sunny, Cloudy, Sunset\n"
    assert mav(capsys, "camera", "settings", "CAM_WBMODE", "Sunset").out == "vehicle 1: CAM_WBMODE: Sunset\n"
    row = json.loads(mav(capsys, "camera", "settings", "CAM_WBMODE", "--json").out)
    assert (row["value"], row["text"]) == (3, "Sunset")
    assert len(json.loads(mav(capsys, "camera", "settings", "--json").out)) == 8
    assert "options: Auto, Sunny" in mav(capsys, "camera", "settings", "CAM_WBMODE", "Night", code=1).err
    assert "has no setting CAM_X" in mav(capsys, "camera", "settings", "CAM_X", code=1).err
    broken = tmp_path / "camera.xml"
    broken.write_text("<mavlinkcamera>")
    mav(capsys, "camera", "settings", "--definition", str(broken), code=1)


def test_a_vehicle_without_a_camera(monkeypatch, capsys):
    CliHarness(monkeypatch)
    assert "vehicle 1 has no camera" in mav(capsys, "camera", "info", code=1).err
    assert "there are no cameras" in mav(capsys, "camera", "list").err


@pytest.mark.parametrize(
    "words",
    [
        ("track", "0.5"),
        ("track", "left", "top"),
        ("track", "0.5", "2"),
        ("mode", "night"),
        ("photo", "--count", "0"),
        ("zoom", "much"),
        ("info", "--camera", "0"),
    ],
)
def test_wrong_usage(harness, capsys, words):
    try:
        code = main(["camera", *words])
    except SystemExit as ended:
        code = ended.code
    assert code in (1, 2)
    assert capsys.readouterr().err


def test_examples_of_the_help_run(harness, capsys):
    for words in examples_of(EXAMPLES):
        if words[1:] == ["video", "start"]:
            mav(capsys, "camera", "mode", "video")
        result = mav(capsys, *words)
        assert result.out or words[1] == "list", words
