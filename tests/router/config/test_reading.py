from __future__ import annotations

import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.errors import RouterConfigError
from mavstack.router.config import (
    EndpointConfig,
    PacketFilter,
    Recording,
    endpoint_from_values,
    load_config,
    parse_config,
    toml_text,
)

TEXT = """\
[router]
duplicate_window = "500 ms"
control = true

[endpoint.autopilot]
url = "serial:///dev/ttyACM0?baud=921600"

[endpoint.ground]
url = "udpin://0.0.0.0:14550"
group = "radio"
rate = "20 kB/s"

[endpoint.ground.rates]
ATTITUDE = 4

[endpoint.ground.in]
deny_commands = ["COMPONENT_ARM_DISARM", 176]
allow_systems = [255]

[endpoint.black-box]
record = "flight.tlog"
max_size = "100 MB"
keep = 5
"""


def test_configuration():
    config = parse_config(TEXT)
    assert config.duplicate_window == 0.5
    assert config.control == "127.0.0.1:7272"
    assert [each.name for each in config.endpoints] == ["autopilot", "ground", "black-box"]
    assert config.endpoint("ground") == EndpointConfig(
        name="ground",
        url="udpin://0.0.0.0:14550",
        group="radio",
        rate=20_000,
        rates=((30, 4.0),),
        incoming=PacketFilter(deny_commands=frozenset({400, 176}), allow_systems=frozenset({255})),
    )
    assert config.endpoint("black-box").record == Recording("flight.tlog", 100_000_000, None, 5)
    assert config.endpoint("no such") is None
    assert config.firewall is None


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("group", "gruop", "router.toml:10: endpoint.ground.gruop is unknown; did you mean group?"),
        ("COMPONENT_ARM", "COMPONENT_RAM", "router.toml:17: endpoint.ground.in.deny_commands is not valid: "),
        ("20 kB/s", "20 parsec", "router.toml:11: endpoint.ground.rate must be bytes per second"),
        ("udpin:", "updin:", "router.toml:9: endpoint.ground.url is not usable: invalid link URL"),
        ("?baud", "?buad", "router.toml:6: endpoint.autopilot.url is not usable: .* did you mean baud"),
        ("ATTITUDE", "ATITUDE", "router.toml:14: endpoint.ground.rates.ATITUDE is not a message"),
        ("= 4", "= 0", "router.toml:14: endpoint.ground.rates.ATTITUDE must be positive"),
        ("= 4", "= 4\n30 = 5", "router.toml:15: endpoint.ground.rates.30 is given twice"),
        ("[router]", "[ruoter]", "router.toml:1: ruoter is unknown; did you mean router?"),
        ("control = true", 'control = "0.0.0.0:1"', "router.control .* unless there is a token"),
        ("control = true", 'control = "here"', "must be a host and a port"),
        ("500 ms", "60", "router.toml:2: router.duplicate_window must be"),
        ('max_size = "100 MB"\n', "", "router.toml:22: endpoint.black-box.keep needs max_size or max_time"),
        ('record = "flight.tlog"\n', "", "router.toml:21: endpoint.black-box.max_size belongs to"),
        ('record = "flight.tlog"', 'url = "unix:///x"\nrecord = "y"', "either a url or a file to record"),
        ('url = "udpin://0.0.0.0:14550"\n', "", "router.toml:8: endpoint.ground has no url"),
        ("black-box", '"black box"', "router.toml:20: endpoint.black box has a name with other characters"),
        ("allow_systems = [255]", "allow_systems = []", "router.toml:18: .* is empty: leave it out"),
        ("allow_systems = [255]", "allow_systems = 255", "router.toml:18: .* must be a list, got 255"),
        ("allow_systems = [255]", "allow_commands = [176]", "router.toml:17: .* both have 176"),
        ("[endpoint.ground]", "[endpoint.ground", "router.toml:8: not valid TOML: expected ']'"),
        ("keep = 5", "keep = true", "router.toml:23: endpoint.black-box.keep must be an integer, got true"),
    ],
)  # fmt: skip
def test_errors_have_file_line_and_remedy(old, new, text):
    assert old in TEXT
    with pytest.raises(RouterConfigError, match=text) as caught:
        parse_config(TEXT.replace(old, new, 1), "router.toml")
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_files(tmp_path):
    path = tmp_path / "router.toml"
    with pytest.raises(RouterConfigError, match=r"cannot open .*: No such file"):
        load_config(path)
    path.write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    assert load_config(path) == parse_config(TEXT)
    path.write_bytes(b"[router]\n\xff")
    with pytest.raises(RouterConfigError, match=r"router.toml:2: not UTF-8"):
        load_config(path)
    path.write_bytes(b"#" * ((1 << 20) + 1))
    with pytest.raises(RouterConfigError, match="larger than 1 MiB"):
        load_config(path)


def test_endpoints_from_values():
    assert endpoint_from_values("x", {"url": "udpout://127.0.0.1:1", "pause": True}, "all").pause
    with pytest.raises(RouterConfigError, match=r"^endpoint.x.puase is unknown; did you mean pause\?$"):
        endpoint_from_values("x", {"url": "udpout://127.0.0.1:1", "puase": True}, "all")


FRAGMENTS = [
    *TEXT.splitlines(keepends=True),
    "[endpoint.x]\n",
    "url = 'udpout://127.0.0.1:1'\n",
    "in = {}\n",
    "[[",
    "]",
]


@pytest.mark.properties
@settings(max_examples=25, deadline=None)
@given(st.lists(st.sampled_from(FRAGMENTS) | st.text(max_size=5), max_size=12))
def test_any_text_is_a_configuration_or_one_error(fragments):
    text = "".join(fragments)
    try:
        config = parse_config(text, "router.toml")
    except RouterConfigError as error:
        line = error.line
    else:
        line = None
        assert parse_config(toml_text(config)) == config
    assert line is None or 1 <= line <= text.count("\n") + 1
