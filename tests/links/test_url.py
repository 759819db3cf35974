from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import LinkError, LinkURLError, MavstackError
from mavstack.links import LinkURL, open_link, parse_url
from mavstack.links.scheme_table import builtin_schemes

ACCEPTED = [
    ("udpin://0.0.0.0:14550", LinkURL("udpin", "0.0.0.0", 14550)),
    ("udpin://:14550", LinkURL("udpin", "0.0.0.0", 14550)),
    ("udpin:0.0.0.0:14550", LinkURL("udpin", "0.0.0.0", 14550)),
    ("udp:127.0.0.1:14550", LinkURL("udpin", "127.0.0.1", 14550)),
    ("udp://:14540", LinkURL("udpin", "0.0.0.0", 14540)),
    ("UDPIN://localhost:1", LinkURL("udpin", "localhost", 1)),
    ("udpout:10.0.0.1:14550", LinkURL("udpout", "10.0.0.1", 14550)),
    ("udpout://drone.local:14550/", LinkURL("udpout", "drone.local", 14550)),
    ("udpbcast:192.168.1.255:14550", LinkURL("udpout", "192.168.1.255", 14550)),
    ("udpout://[fe80::1%eth0]:14550", LinkURL("udpout", "fe80::1%eth0", 14550)),
    ("udpin://[::]:14550", LinkURL("udpin", "::", 14550)),
    ("tcp:127.0.0.1:5760", LinkURL("tcpout", "127.0.0.1", 5760)),
    ("tcp://127.0.0.1:5760", LinkURL("tcpout", "127.0.0.1", 5760)),
    ("tcpout://127.0.0.1:5760", LinkURL("tcpout", "127.0.0.1", 5760)),
    ("tcpin:0.0.0.0:5760", LinkURL("tcpin", "0.0.0.0", 5760)),
    ("tls://ground.example:5761?ca=a.pem", LinkURL("tls", "ground.example", 5761, "", {"ca": "a.pem"})),
    ("ws://127.0.0.1:5770", LinkURL("ws", "127.0.0.1", 5770, "/")),
    ("wss://ground.example/a/b", LinkURL("wss", "ground.example", 443, "/a/b")),
    ("wsserver:0.0.0.0:5770", LinkURL("wsin", "0.0.0.0", 5770, "/")),
    ("/dev/ttyACM0", LinkURL("serial", path="/dev/ttyACM0")),
    ("/dev/ttyACM0,57600", LinkURL("serial", path="/dev/ttyACM0", options={"baud": "57600"})),
    ("/dev/ttyACM0:57600", LinkURL("serial", path="/dev/ttyACM0", options={"baud": "57600"})),
    ("/dev/ttyACM0?baud=9600", LinkURL("serial", path="/dev/ttyACM0", options={"baud": "9600"})),
    ("/dev/serial/by-path/pci-0000:00:14", LinkURL("serial", path="/dev/serial/by-path/pci-0000:00:14")),
    ("COM3", LinkURL("serial", path="COM3")),
    ("com3,57600", LinkURL("serial", path="com3", options={"baud": "57600"})),
    ("COM3?baud=57600", LinkURL("serial", path="COM3", options={"baud": "57600"})),
    (r"\\.\COM12", LinkURL("serial", path=r"\\.\COM12")),
    ("serial:///dev/ttyACM0?baud=57600", LinkURL("serial", path="/dev/ttyACM0", options={"baud": "57600"})),
    ("serial:///dev/ttyACM0:57600", LinkURL("serial", path="/dev/ttyACM0", options={"baud": "57600"})),
    ("serial:/dev/ttyUSB0:921600", LinkURL("serial", path="/dev/ttyUSB0", options={"baud": "921600"})),
    ("serial://COM3:57600", LinkURL("serial", path="COM3", options={"baud": "57600"})),
    ("serial_flowcontrol://COM3", LinkURL("serial", path="COM3", options={"flow": "rtscts"})),
    ("unix:///run/mav.sock", LinkURL("unix", path="/run/mav.sock")),
    ("unix://mav.sock", LinkURL("unix", path="mav.sock")),
    ("file://flight.tlog", LinkURL("file", path="flight.tlog")),
    ("file:///logs/a%20b.tlog?speed=2", LinkURL("file", path="/logs/a b.tlog", options={"speed": "2"})),
    ("file:///C:/logs/flight.tlog", LinkURL("file", path="C:/logs/flight.tlog")),
    ("flight.tlog", LinkURL("file", path="flight.tlog")),
    ("FLIGHT.TLOG?speed=max", LinkURL("file", path="FLIGHT.TLOG", options={"speed": "max"})),
    ("./logs/00000001.raw", LinkURL("file", path="./logs/00000001.raw")),
    (r"C:\logs\flight.tlog", LinkURL("file", path=r"C:\logs\flight.tlog")),
    ("logs/2024:01:02.tlog", LinkURL("file", path="logs/2024:01:02.tlog")),
    ("memory://fleet", LinkURL("memory", path="fleet")),
    (" udpin://0.0.0.0:14550 ", LinkURL("udpin", "0.0.0.0", 14550)),
    ("udpin://:0?loss=10%25&seed=7&", LinkURL("udpin", "0.0.0.0", 0, "", {"loss": "10%", "seed": "7"})),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), ACCEPTED)
def test_accepted_urls(text, expected):
    assert parse_url(text) == expected


@pytest.mark.parametrize("url", [expected for _, expected in ACCEPTED], ids=str)
def test_the_canonical_form_parses_to_the_same_url(url):
    assert parse_url(str(url)) == url


@pytest.mark.parametrize(
    ("scheme", "example"), [(each.name, each.example) for each in builtin_schemes().values()]
)
def test_every_example_is_valid(scheme, example):
    assert parse_url(example).scheme == scheme
    assert parse_url(str(parse_url(example))) == parse_url(example)


REFUSED = [
    ("", "it is empty"),
    ("drone", "no scheme, and is not a device or file"),
    ("127.0.0.1:14550", "udpin://127.0.0.1:14550 listens, udpout://127.0.0.1:14550 sends"),
    ("localhost:14550", "udpin://localhost:14550 listens"),
    ("udpni://0.0.0.0:14550", r"unknown scheme 'udpni'; did you mean udpin\?; for example: udpin://"),
    ("zigbee://1", "known schemes: tcpin, tcpout"),
    ("udpin://", "no port; for example: udpin://"),
    ("udpin://0.0.0.0", "no port"),
    ("udpin://0.0.0.0:", "no port"),
    ("udpin://0.0.0.0:http", "the port 'http' is not a number"),
    ("udpin://0.0.0.0:1²", "is not a number"),
    ("udpin://0.0.0.0:65536", "65536 is not between 0 and 65535"),
    ("udpout://10.0.0.1:0", "0 is not between 1 and 65535"),
    ("udpout://:14550", "no host"),
    ("tcpout://::1:5760", r"needs brackets, as in \[::1\]"),
    ("tcpout://a b:5760", "the host is not valid"),
    ("tcpout://a:1:2", "brackets"),
    ("tcpin://0.0.0.0:5760/path", "takes no path"),
    ("serial://", "has no device"),
    ("serial://,57600", "no device|not a serial"),
    ("file://", "no path"),
    ("unix:///", "no path"),
    ("memory://", "has no name"),
    ("udpin://0.0.0.0:1?idle", "not have the form name=value"),
    ("udpin://0.0.0.0:1?idle=1&idle=2", "given twice"),
]


@pytest.mark.parametrize(("text", "problem"), REFUSED)
def test_a_refused_url_raises_with_an_example(text, problem):
    with pytest.raises(LinkURLError, match=problem) as caught:
        parse_url(text)
    assert "://" in str(caught.value)
    assert isinstance(caught.value, LinkError)
    assert isinstance(caught.value, ValueError)


@given(st.text(max_size=60) | st.from_regex(r"[a-z]{2,6}:(//)?[^\n]{0,40}"))
def test_any_text_is_accepted_or_refused(text):
    try:
        url = parse_url(text)
    except MavstackError:
        return
    assert parse_url(str(url)).scheme == url.scheme


@pytest.mark.parametrize("name", ["key", "password", "auth_token", "client_secret"])
def test_secret_options_are_redacted(name):
    url = parse_url(f"tcpout://h:1?retry=1&{name}=hunter2")
    assert url.options[name] == "hunter2"
    assert url.redacted == f"tcpout://h:1?retry=1&{name}=***"


def test_error_texts_contain_no_secrets():
    with pytest.raises(LinkURLError) as caught:
        parse_url("tcpout://?password=hunter2&wait=yes")
    assert "hunter2" not in str(caught.value)
    with pytest.raises(LinkURLError) as caught:
        open_link("tcpout://h:1?password=hunter2")
    assert "hunter2" not in str(caught.value)


def test_options_are_added_and_replaced():
    url = parse_url("tcpout://h:1?retry=1").with_options(retry=2.5, reconnect=False, wait=True)
    assert url.options == {"retry": "2.5", "reconnect": "no", "wait": "yes"}
    assert len({url, url.with_options()}) == 1
