from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.errors import RouterConfigError
from mavstack.router.config import EndpointConfig, PacketFilter, Recording, parse_config, toml_text
from mavstack.router.mavlink_router_config import parse_mavlink_router_config, read_mavlink_router_config

TEXT = """\
# companion computer
[General]
TcpServerPort = 5790
DeduplicationPeriod=500
Log = /var/log/flights/
LogTelemetry = true
LogMode = while-armed
MaxLogFiles = 7
ReportStats = true
SnifferSysid = 254

[UartEndpoint Autopilot]
device = /dev/ttyS1
Baud = 921600, 57600
FlowControl = 1
Group = radio

[udpendpoint ground]
Mode = Server
Address = 0.0.0.0
Port = 14550
Filter = 0, 30
BlockSrcSysIn = 51
AllowSrcCompIn = 1,191

[UdpEndpoint other]
Mode = Normal
Address = 10.0.0.2

[UdpEndpoint third]
Mode = normal
Address = 10.0.0.2
Colour = blue

[TcpEndpoint ground]
Address = [::1]
Port = 5760
RetryTimeout = 0

; the same section again
[UartEndpoint autopilot]
BlockMsgIdOut = 76
[Future x]
"""


def test_every_kind_of_endpoint():
    config = parse_mavlink_router_config(TEXT, "main.conf").config
    assert config.duplicate_window == 0.5
    assert config.endpoints == (
        EndpointConfig("tcp-server", "tcpin://0.0.0.0:5790"),
        EndpointConfig("telemetry-log", record=Recording("/var/log/flights/telemetry.tlog", 10**9, None, 7)),
        EndpointConfig(
            "Autopilot",
            "serial:///dev/ttyS1?baud=921600&flow=rtscts",
            group="radio",
            outgoing=PacketFilter(deny_messages=frozenset({76})),
        ),
        EndpointConfig(
            "ground",
            "udpin://0.0.0.0:14550",
            incoming=PacketFilter(deny_systems=frozenset({51}), allow_components=frozenset({1, 191})),
            outgoing=PacketFilter(allow_messages=frozenset({0, 30})),
        ),
        EndpointConfig("other", "udpout://10.0.0.2:14550"),
        EndpointConfig("third", "udpout://10.0.0.2:14551"),
        EndpointConfig("ground-tcp", "tcpout://[::1]:5760?reconnect=no"),
    )


def test_settings_without_an_equal_are_notes_with_their_line():
    notes = parse_mavlink_router_config(TEXT, "main.conf").notes
    assert [note.split(": ")[:2] for note in notes] == [
        ["main.conf:9", "reportstats has no equal"],
        ["main.conf:10", "sniffersysid has no equal"],
        ["main.conf:7", "LogMode"],
        ["main.conf:14", "Baud"],
        ["main.conf:33", "colour is unknown and has no effect"],
        ["main.conf:43", "the section [future] is unknown and has no effect"],
    ]


def test_defaults():
    config = parse_mavlink_router_config("[TcpEndpoint a]\nAddress = 10.0.0.1\nPort = 1\n").config
    assert [each.url for each in config.endpoints] == [
        "tcpout://10.0.0.1:1?wait=yes&retry=5s&retry_limit=5s",
        "tcpin://0.0.0.0:5760",
    ]
    assert not parse_mavlink_router_config("[General]\nTcpServerPort=0").config.endpoints
    (log,) = parse_mavlink_router_config("[General]\nTcpServerPort=0\nLog = /logs").notes
    assert "mav log get" in log


def test_the_result_is_a_configuration_of_ours():
    config = parse_mavlink_router_config(TEXT).config
    assert parse_config(toml_text(config)) == config


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("Port = 1", "main.conf:1: a setting before the first section"),
        ("[General", "main.conf:1: .* ends with"),
        ("[UdpEndpoint a b]", "main.conf:1: .* has no blanks"),
        ("[General]\nTcpServerPort", "main.conf:2: .* not a setting"),
        ("[General]\nTcpServerPort = x", "main.conf:2: tcpserverport must be a number from 0 to 65535"),
        ("[UdpEndpoint]", "main.conf:1: the section needs a name"),
        ("[UdpEndpoint a]\nMode=Server\nAddress=1.2.3.4", "main.conf:1: port is needed in server mode"),
        ("[UdpEndpoint a]\nMode=Other\nAddress=1.2.3.4", "main.conf:2: mode must be Normal or Server"),
        ("[UdpEndpoint a]\nMode=Normal\nAddress=host", "main.conf:3: address must be an IP address"),
        ("[UartEndpoint a]\nBaud=1", "main.conf:1: device is missing"),
        (
            "[UartEndpoint a]\nDevice=/dev/x\nAllowSrcSysIn=1,300",
            "main.conf:3: allowsrcsysin must be numbers",
        ),
        (
            "[UartEndpoint a]\nDevice=/dev/x\nFlowControl=maybe",
            "main.conf:3: flowcontrol must be true or false",
        ),
    ],
)
def test_errors_have_file_and_line(text, problem):
    with pytest.raises(RouterConfigError, match=problem):
        parse_mavlink_router_config(text, "main.conf")


def test_files(tmp_path):
    with pytest.raises(RouterConfigError, match=r"cannot open .*: No such file"):
        read_mavlink_router_config(tmp_path / "main.conf")
    (tmp_path / "main.conf").write_text(TEXT)
    assert (
        read_mavlink_router_config(tmp_path / "main.conf").config == parse_mavlink_router_config(TEXT).config
    )


@pytest.mark.properties
@settings(max_examples=25, deadline=None)
@given(st.lists(st.sampled_from(TEXT.splitlines(keepends=True)) | st.text(max_size=5), max_size=12))
def test_any_text_is_a_configuration_or_one_error(lines):
    try:
        config = parse_mavlink_router_config("".join(lines), "main.conf").config
    except RouterConfigError as error:
        text = str(error)
    else:
        text = "main.conf"
        assert parse_config(toml_text(config)) == config
    assert text.startswith("main.conf")
