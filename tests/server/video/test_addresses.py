from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.server.video.addresses import read_address


@pytest.mark.parametrize("text", ["rtsp://192.168.1.10:8554/front", "rtsps://user:word@camera.example/a?b=1"])
def test_rtsp_addresses_are_opened_as_they_are(text):
    assert read_address(f" {text} ").url == text


@pytest.mark.parametrize("text", ["5600", "udp://0.0.0.0:5600", "rtp://0.0.0.0:5600"])
def test_rtp_is_described(text):
    description = read_address(text).description
    assert "m=video 5600 RTP/AVP 96\r\n" in description
    assert "H264/90000" in description
    assert "H265/90000" in read_address(text, is_h265=True).description


@pytest.mark.parametrize(
    "text",
    [
        "", "file:///etc/passwd", "/etc/passwd", "concat:a|b", "http://127.0.0.1/x", "rtsp://", "udp://0.0.0.0",
        "rtsp://host/a b", "rtsp://host/\r\nX: 1", "rtp://0.0.0.0:99999", "rtsp://ho|st/a",
        "subfile,,start,0,:x", "rtsp://" + "a" * 600, "tls://host:1", "rtp://0.0.0.0\r\na=x:5600", "rtsp://host/a#b\0",
    ],
)  # fmt: skip
def test_other_addresses_are_refused(text):
    with pytest.raises(InvalidArgumentError, match="playing"):
        read_address(text)


def test_a_password_is_not_shown():
    with pytest.raises(InvalidArgumentError) as error:
        read_address("http://user:word@camera/x")
    assert "word" not in str(error.value)


@given(st.text(max_size=80))
def test_any_text_is_refused_or_safe(text):
    try:
        found = read_address(f"rtp://{text}")
    except InvalidArgumentError:
        return
    assert found.description.count("\r\n") == 7
