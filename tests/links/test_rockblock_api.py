"""Web hooks of RockBLOCK: forms and JSON, repeated and damaged ones."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.links.rockblock_api import Delivered, Hook, failure_of, message_form, parse_hook

IMEI = "300234010753370"
FIELDS = {"imei": IMEI, "momsn": "12345", "data": "48656c6c6f"}


def test_forms_and_json():
    form = f"imei={IMEI}&serial=1&momsn=12345&transmit_time=21-10-31&data=48656c6c6f".encode()
    assert parse_hook(form) == parse_hook(json.dumps(FIELDS).encode()) == Hook(IMEI, "12345", b"Hello")
    assert (
        message_form(IMEI, "me", "a b", b"\x01") == f"imei={IMEI}&username=me&password=a+b&data=01".encode()
    )


@pytest.mark.parametrize(
    "change", [{"imei": "x"}, {"imei": "1" * 30}, {"data": "4"}, {"data": "zz"}, {"data": "00" * 341}]
)
def test_wrong_hooks(change):
    assert parse_hook(json.dumps(FIELDS | change).encode()) is None


def test_each_message_once():
    delivered = Delivered()
    assert [delivered.is_new(Hook(IMEI, number, b"x")) for number in ("1", "1", "2", "", "")] == [
        *(True, False, True),
        *(True, True),
    ]


def test_answers_of_the_gateway():
    assert failure_of(b"OK,4114651") == ""
    assert failure_of(b"FAILED,10,Invalid login credentials").startswith("FAILED")
    assert failure_of(b"") == "an empty answer"


@given(st.one_of(st.binary(max_size=300), st.binary(max_size=200).map(lambda tail: b"{" + tail)))
def test_any_bytes(body):
    hook = parse_hook(body)
    assert hook is None or len(hook.data) <= 340
