"""The tables of messages as JSON."""

from __future__ import annotations

import json

from mavstack.msp.messages.config import FeatureConfig
from mavstack.msp.messages.layout_tables import message_facts, msp_facts
from mavstack.msp.messages.modes import SetModeRange
from mavstack.msp.messages.registry import all_messages


def test_every_message_is_there_with_its_command() -> None:
    found = json.loads(json.dumps(msp_facts()))
    assert {name: each["command"] for name, each in found["messages"].items()} == {
        message.__name__: message.COMMAND for message in all_messages()
    }
    assert found["modes"]["INAV"]["10"] == "NAV RTH"
    assert found["armingReasons"]["7"] == "THROTTLE"


def test_a_field_has_its_scale_its_version_and_its_names() -> None:
    fields = {each["name"]: each for each in message_facts(SetModeRange)["fields"]}
    assert fields["start"]["codec"] == {"kind": "u8", "step": 25, "offset": 900}
    assert (fields["logic"]["since"], fields["logic"]["optional"]) == ("1.41", True)
    (features,) = message_facts(FeatureConfig)["fields"]
    assert features["codec"]["BTFL"]["bits"][1 << 7] == "GPS"
