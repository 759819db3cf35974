from __future__ import annotations

import json
from time import time

import pytest

from mavstack.security.tickets import TicketVerifier


@pytest.fixture
def key_file(tmp_path):
    path = tmp_path / "gate.txt"
    path.write_text("ados_secret\n")
    return str(path)


def test_a_ticket_is_valid_and_the_key_is_not_shown(mav, key_file):
    result = mav("key", "ticket", key_file)
    assert (result.code, result.err) == (0, "")
    assert TicketVerifier("ados_secret").verify(result.out.strip(), time()) is None
    assert "ados_secret" not in result.out


def test_json(mav, key_file):
    made = json.loads(mav("key", "ticket", key_file, "--scope", "gs.other", "--lifetime", "60", "--json").out)
    assert made["scope"] == "gs.other"
    assert made["ticket"].split("|")[3] == str(made["expires"])


@pytest.mark.parametrize(
    ("option", "problem"),
    [(("--lifetime", "121"), "lifetime must be 1 to 120 s"), (("--scope", "a b"), "scope must be")],
)
def test_bad_values_are_reported_in_one_line(mav, key_file, option, problem):
    result = mav("key", "ticket", key_file, *option)
    assert result.code != 0
    assert problem in result.err
    assert result.err.count("\n") == 1
