"""Errors as answers: their JSON has the reasons that the error has in Python."""

from __future__ import annotations

from mavstack.errors import CommandDenied
from mavstack.server.problems import problem_json, status_of


def refused(*events: str) -> CommandDenied:
    error = CommandDenied("arming", "1/1", answer="FAILED", code=4)
    error.status_texts, error.events = ("Arming denied",), events
    return error


def test_a_refusal_has_the_status_texts_and_the_events() -> None:
    error = refused("Compass needs calibration", "No manual control input")
    found = problem_json(error)["error"]
    assert status_of(error) == 409
    assert found["code"] == 4
    assert found["status_texts"] == ["Arming denied"]
    assert found["events"] == ["Compass needs calibration", "No manual control input"]


def test_without_events_the_answer_has_none() -> None:
    assert "events" not in problem_json(refused())["error"]
