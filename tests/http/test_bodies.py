from __future__ import annotations

import pytest
from starlette.requests import Request

from mavstack.http.bodies import RefusedError, has_body, parse_json, read_json_object


def request(body, content_type="application/json"):
    async def receive():
        return {"type": "http.request", "body": body, "more_body": False}

    headers = [(b"content-type", content_type.encode())]
    return Request({"type": "http", "method": "POST", "headers": headers}, receive)


async def test_a_json_object():
    assert await read_json_object(request(b'{"a": 1}', "Application/JSON; charset=utf-8")) == {"a": 1}


@pytest.mark.parametrize(
    ("body", "content_type", "status"),
    [
        (b"{}", "text/plain", 415),
        (b"[]", "application/json", 400),
        (b"{", "application/json", 400),
        (b"\xff\xfe{", "application/json", 400),
        (b"[" * 9000, "application/json", 400),
        (b" " * 9001, "application/json", 413),
    ],
)
async def test_other_bodies_are_refused(body, content_type, status):
    with pytest.raises(RefusedError) as caught:
        await read_json_object(request(body, content_type), max_size=9000)
    assert caught.value.status == status


def test_numbers_that_are_not_json():
    assert parse_json("NaN") is parse_json('{"a": -Infinity}') is None
    assert parse_json("[1e999]") is parse_json(f"[-{'9' * 400}]") is None
    assert parse_json("[18446744073709551615, 1e300]") == [2**64 - 1, 1e300]
    assert parse_json("1" * 30) == pytest.approx(1.1111111111e29)


@pytest.mark.parametrize("text", [r'"\ud800"', r'{"\udfff": 1}', b'["\\ud83d"]'])
def test_halves_of_surrogate_pairs_are_refused(text):
    assert parse_json(text) is None
    assert parse_json(r'"\ud83d\ude80"') == "\N{ROCKET}"


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ([], False),
        ([(b"content-length", b"0")], False),
        ([(b"content-length", b" 00 ")], False),
        ([(b"content-length", b"20")], True),
        ([(b"transfer-encoding", b"chunked")], True),
    ],
)
def test_a_head_reports_whether_there_is_a_body(fields, expected):
    assert has_body({"headers": fields}) is expected
