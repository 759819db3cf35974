from __future__ import annotations

import json

import pytest

from mavstack.cli.common.field_values import HIDDEN
from mavstack.cli.watch.packet_lines import json_line, text_line
from mavstack.dialects import Dialect, common, minimal
from mavstack.wire import Packet, encode
from tests.cli.conftest import flight, setup_signing, stamped

SECRET = bytes(range(100, 132))

SECRETS = [
    common.SetupSigning(secret_key=SECRET, initial_timestamp=987654321),
    common.AuthKey(key="hunter2secret"),
    common.ChangeOperatorControl(passkey="hunter2secret"),
    common.WifiConfigAp(ssid="drone", password="hunter2secret"),
    common.CellularConfig(pin="hunter2secret", new_pin="hunter2secret", puk="hunter2secret"),
    Dialect.load("all")["AIRLINK_AUTH"](login="me", password="hunter2secret"),
]
TRACES = [
    "hunter2secret",
    "987654321",
    SECRET.hex(),
    SECRET.hex(" "),
    str(list(SECRET))[1:-1],
    b"hunter2secret".hex(),
    "100 101 102",
]


def assert_hidden(text: str) -> None:
    assert not [trace for trace in TRACES if trace in text]


@pytest.mark.parametrize("message", SECRETS, ids=lambda message: type(message).__name__)
@pytest.mark.parametrize("dialect", ["all", "minimal"])
def test_no_line_shows_a_secret(message, dialect):
    raw = encode(message, system=1, component=1)
    packet = Packet(raw, Dialect.load(dialect))
    for line in (json_line(packet, 1.5), text_line(packet, 1.5)):
        assert_hidden(line)
        assert HIDDEN in line


def test_an_unknown_packet_without_secret_is_shown_raw():
    raw = encode(common.Attitude(roll=1), system=1, component=1)
    line = json.loads(json_line(Packet(raw, minimal), None))
    assert line == {"time": None, "system": 1, "component": 1, "id": 30, "message": None, "raw": raw.hex()}


@pytest.mark.parametrize("options", [["--once"], ["--once", "--json"], ["--json"], []])
@pytest.mark.parametrize("dialect", ["all", "minimal"])
def test_no_output_shows_a_secret(mav, tmp_path, options, dialect):
    path = tmp_path / "keys.tlog"
    path.write_bytes(stamped([*flight(), setup_signing()]))
    result = mav("watch", path, "--dialect", dialect, *options)
    assert result.code == 0
    assert_hidden(result.out + result.err)
