"""Notifications while the shell runs."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.cli.shell.notifications import Notifications, print_notification
from mavstack.cli.shell.prompt_parts import prompt_parts
from mavstack.cli.shell.runner import run_line
from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.links import LinkDown
from mavstack.services import Address
from mavstack.services.events import DecodedEvent, LogLevel
from mavstack.services.statustext import StatusText
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell


@pytest.mark.flight
def test_notifications_go_to_stderr(capsys):
    async def scenario(session, world):
        async with Notifications(session):
            with pytest.raises(CommandDenied):
                await run_line(session, "mode auto; long COMPONENT_ARM_DISARM 1")
            await asyncio.sleep(1)

    in_shell(COPTER, scenario)
    captured = capsys.readouterr()
    assert "arm" in captured.err.lower()
    assert captured.out == "mode AUTO\n"


@pytest.mark.flight
def test_vehicle_lost_and_returned(capsys):
    async def scenario(session, world):
        async with Notifications(session):
            world.simulated.autopilot  # noqa: B018
            links = list(world.node.links[0].channels)
            for channel in links:
                channel.close()
            await asyncio.sleep(1)
            assert "".join(text for _, text in prompt_parts(session)) == "1 silent> "

    in_shell(COPTER, scenario)
    assert "vehicle 1 lost: its link" in capsys.readouterr().err


@pytest.mark.flight
def test_an_event_is_printed_once(capsys):
    async def scenario(session, world):
        async with Notifications(session):
            for line in ("arm", "disarm", "arm", "disarm"):
                await run_line(session, line)
                await asyncio.sleep(2)

    in_shell(PX4_COPTER, scenario)
    lines = [line for line in capsys.readouterr().err.splitlines() if "rmed" in line]
    # The metadata is downloaded with the first event, which is known from its status text until then.
    assert lines == [
        "Armed by external command",
        "Disarmed, reason: external command",
        "Armed, reason: external command",
        "Disarmed, reason: external command",
    ]


def test_events_replace_the_texts_of_their_component():
    def event(message: str = "Armed, reason: stick gesture", name: str = "px4::armed") -> DecodedEvent:
        return DecodedEvent(Address(1, 1), 1, 1, 0.0, 0.0, LogLevel.INFO, LogLevel.INFO, name, message)

    async def scenario(session):
        line = Notifications(session).line
        marked = StatusText(Address(1, 1), 6, "Armed by stick gesture", has_event=True)
        assert line(event("event 0x1", name="")) is None
        assert line(marked) == ("Armed by stick gesture", "")
        assert line(event()) is None, "its text was printed"
        assert line(event()) == ("Armed, reason: stick gesture", "")
        assert line(marked) is None
        assert line(StatusText(Address(1, 1), 6, "without an event"))
        assert line(StatusText(Address(2, 1), 6, "another vehicle", has_event=True))
        await run_line(session, "set severity warning")
        assert line(event()) is None

    alone(scenario)


def test_severity_setting():
    async def scenario(session):
        notifications = Notifications(session)
        text = StatusText(Address(1, 1), int(common.MavSeverity.INFO), "hello\x1b[2J", True)
        assert notifications.line(text) == ("hello\N{REPLACEMENT CHARACTER}[2J", "")
        await run_line(session, "set severity warning")
        assert notifications.line(text) is None
        critical_text = StatusText(Address(1, 1), int(common.MavSeverity.CRITICAL), "Crash", True)
        assert notifications.line(critical_text) == ("Crash", "alarm")
        own = StatusText(session.connection.address, 0, "mine", True)
        assert notifications.line(own) is None
        assert notifications.line(StatusText(Address(1, 1), 0, "odd", True))[1] == "alarm"

    alone(scenario)


@pytest.mark.flight
def test_system_id_is_shown_for_several_vehicles():
    async def scenario(session, world):
        await world.wait_until(lambda: len(session.connection.vehicles) == 2)
        line = Notifications(session).line(StatusText(Address(2, 1), 4, "low battery", True))
        assert line == ("2: low battery", "yellow")

    in_shell([COPTER, PX4_COPTER], scenario)


def test_link_down():
    async def scenario(session):
        notifications = Notifications(session)
        assert notifications.line(LinkDown("refused", 2.0)) == ("link down: refused; next try in 2 s", "red")
        assert notifications.line(LinkDown("gone", float("inf"))) == ("link down: gone", "red")

    alone(scenario)


@pytest.mark.flight
def test_the_prompt(capsys):
    async def scenario(session, world):
        def prompt():
            return "".join(text for _, text in prompt_parts(session))

        assert prompt() == "1 STABILIZE> "
        await run_line(session, "arm")
        assert prompt() == "1 STABILIZE armed> "

    in_shell(COPTER, scenario)

    async def without_vehicle(session):
        assert prompt_parts(session)[0] == ("silent", "no vehicle")

    alone(without_vehicle)


def test_no_escape_sequences_in_a_pipe(capsys):
    print_notification("hello", "red")
    assert capsys.readouterr().err == "hello\n"
