"""`mav msp osd` against a small flight controller, in virtual time."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from mavstack.cli.msp.osd import draw
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.osd import OsdConfig, SetOsdItem
from mavstack.msp.messages.osd_items import OsdPosition
from tests.bridges.msp.controllers import IDENTITY

DEVICE = "/dev/ttyACM9"
INFO = FirmwareInfo("BTFL", (4, 5, 1), (1, 46))
CONFIG, SET_CONFIG = 84, 85


@pytest.fixture
def places(firmware):
    """The places of three items of a firmware that keeps those which it is sent."""
    places = [OsdPosition(1, 2, (1, 2)), OsdPosition(10, 14, (1,)), OsdPosition(14, 6)]

    def answer(_):
        items = tuple(place.to_bits() for place in places)
        return OsdConfig(
            1,
            0,
            1,
            rssi_alarm=20,
            capacity_alarm=2200,
            reserved=0,
            item_count=3,
            altitude_alarm=100,
            items=items,
        ).encode(INFO)

    def keep(payload):
        item = SetOsdItem.decode(payload, INFO)
        places[item.item] = OsdPosition.from_bits(item.position)
        return b""

    firmware.replies = {**IDENTITY, CONFIG: answer, SET_CONFIG: keep}
    return places


def test_items(places, capsys):
    assert main(["msp", "osd", DEVICE]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[1:] == [
        ["RSSI_VALUE", "1", "2", "1,2"],
        ["MAIN_BATT_VOLTAGE", "10", "14", "1"],
        ["CROSSHAIRS", "14", "6", "off"],
    ]
    assert main(["msp", "osd", DEVICE, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["columns"], document["rows"]) == (30, 16)
    assert document["items"]["CROSSHAIRS"] == {"column": 14, "row": 6, "profiles": []}


def test_the_picture(places, capsys):
    assert main(["msp", "osd", DEVICE, "--draw"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 16
    assert lines[2] == "·RSSI_VALUE" + "·" * 19
    assert lines[14] == "·" * 10 + "MAIN_BATT_VOLTAGE···"
    assert draw({"LONG_NAME": OsdPosition(2, 0, (2,))}, (5, 1), 2) == ["··LON"]


def test_items_are_moved_and_hidden(places, capsys):
    assert main(["msp", "osd", DEVICE, "crosshairs=3,4", "RSSI_VALUE=off", "--profile", "2"]) == 0
    out, err = capsys.readouterr()
    assert "CROSSHAIRS: off → 3,4 in profile 2\nRSSI_VALUE: 1,2 in profile 1,2 → 1,2 in profile 1\n" in out
    assert err.startswith("not saved")
    assert places == [OsdPosition(1, 2, (1,)), OsdPosition(10, 14, (1,)), OsdPosition(3, 4, (2,))]


@pytest.mark.parametrize(
    ("word", "code"), [("CROSSHAIRS", 2), ("CROSSHAIRS=64,1", 2), ("CROSSHAIRS=1", 2), ("CROSHAIRS=1,1", 1)]
)
def test_wrong_words(places, capsys, word, code):
    assert main(["msp", "osd", DEVICE, word]) == code


def test_controllers_without_this_display(firmware, capsys):
    assert main(["msp", "osd", DEVICE]) == 1
    assert "has no on-screen display" in capsys.readouterr().err
    firmware.replies[2] = b"INAV"
    assert main(["msp", "osd", DEVICE]) == 1
    assert "iNav has another layout" in capsys.readouterr().err
