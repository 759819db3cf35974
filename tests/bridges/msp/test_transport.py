from __future__ import annotations

import pytest

from mavstack import LinkURLError
from mavstack.bridges.msp.transport import msp_name, transport_url
from mavstack.links import parse_url


@pytest.mark.parametrize(
    ("text", "url"),
    [
        ("msp+tcp://127.0.0.1:5761", "tcpout://127.0.0.1:5761"),
        ("MSP+TCP://127.0.0.1:5761?reconnect=no", "tcpout://127.0.0.1:5761?reconnect=no"),
        ("tcp:127.0.0.1:5761", "tcpout://127.0.0.1:5761"),
        ("msp+tcpin://127.0.0.1:5761", "tcpin://127.0.0.1:5761"),
        ("msp+tcp://[::1]:5761", "tcpout://[::1]:5761"),
        ("msp+serial:///dev/ttyACM0", "serial:///dev/ttyACM0?baud=115200"),
        ("msp+serial:///dev/ttyACM0?baud=57600", "serial:///dev/ttyACM0?baud=57600"),
        ("msp+serial:///dev/ttyACM0:57600", "serial:///dev/ttyACM0?baud=57600"),
        ("/dev/ttyACM0", "serial:///dev/ttyACM0?baud=115200"),
        ("COM3", "serial://COM3?baud=115200"),
        ("./quad", "serial://./quad?baud=115200"),
    ],
)
def test_urls_of_links(text: str, url: str):
    assert str(transport_url(text)) == url


def test_an_ipv6_address_in_a_parsed_url():
    parsed = parse_url("msp+tcp://[::1]:5761?reconnect=no", {"msp+tcp"})
    assert str(transport_url(parsed)) == "tcpout://[::1]:5761?reconnect=no"


def test_the_baud_rate_of_an_option():
    assert str(transport_url("/dev/ttyUSB0?baud=9600", 57600)) == "serial:///dev/ttyUSB0?baud=57600"


@pytest.mark.parametrize("text", ["udpin://0.0.0.0:14550", "wsin://0.0.0.0:1", "", "msp+udp://1.2.3.4:5"])
def test_urls_that_carry_no_msp(text: str):
    with pytest.raises(LinkURLError):
        transport_url(text)


def test_names_in_error_texts():
    assert msp_name(transport_url("/dev/ttyACM0")) == "msp+serial:///dev/ttyACM0"
    assert msp_name(transport_url("tcp:127.0.0.1:5761?reconnect=no")) == "msp+tcp://127.0.0.1:5761"
