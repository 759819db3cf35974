"""`mav bridge check` against a router."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.main import main
from tests.bridges.ros2.running import zenoh_router


@pytest.mark.interop
def test_no_bridge_is_a_problem(capsys: pytest.CaptureFixture[str]) -> None:
    with zenoh_router() as port:
        assert main(["bridge", "check", "--connect", f"tcp/127.0.0.1:{port}", "--json"]) == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert found["ok"] is False
    assert found["text"].startswith("no vehicle is in domain 0")


@pytest.mark.interop
def test_a_fleet_without_a_gateway(capsys: pytest.CaptureFixture[str]) -> None:
    with zenoh_router() as port:
        assert main(["bridge", "check", "zenoh", "--connect", f"tcp/127.0.0.1:{port}"]) == 1
    assert capsys.readouterr().out.startswith("problem  no gateway serves the fleet mavstack")


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        ("mqtt --prefix a#", 2, "argument --prefix: must be a topic without wildcards and spaces, got 'a#'"),
        ("zenoh --prefix a*", 1, "a prefix of keys must have letters, digits, _, - and ., got 'a*'"),
        ("otel --otlp http://[::1", 1, "a collector must be http://HOST:4318, got 'http://[::1'"),
    ],
    ids=["mqtt", "zenoh", "otel"],
)
def test_options_that_are_not_possible(
    words: str, code: int, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("zenoh")
    assert main(["bridge", "check", *words.split()]) == code
    assert capsys.readouterr().err.endswith(f"{text}\n")
