from __future__ import annotations

import pytest

from mavstack import InvalidArgumentError, InvalidStateError, MspDenied, MspTimeout, RemoteCancelled
from mavstack.msp import Direction, Frame, FrameParser, FrameVersion, Priority, Request, RequestEngine
from mavstack.msp.frame import NO_REPLY
from mavstack.msp.requests import MAX_WAIT


class Line:
    """An engine, and the frames that it has sent."""

    def __init__(self) -> None:
        self.engine = RequestEngine("test")
        self.now = 0.0
        self.parser = FrameParser()

    def sent(self) -> list[Frame]:
        self.engine.step(self.now)
        return self.parser.feed(self.engine.data_to_send())

    def commands(self) -> list[int]:
        return [frame.command for frame in self.sent()]

    def reply(self, command: int, payload: bytes = b"", direction: Direction = Direction.RESPONSE) -> None:
        self.engine.receive(Frame(command, payload, direction).encode(), self.now)

    def wait(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def line() -> Line:
    return Line()


def test_a_request_ends_with_the_payload_of_its_reply(line: Line) -> None:
    ended: list[Request] = []
    request = line.engine.request(108, callback=ended.append)
    with pytest.raises(InvalidStateError, match="has not ended"):
        request.result()
    assert line.sent() == [Frame(108)]
    line.wait(0.01)
    line.reply(108, b"abc")
    assert (request.done, request.result(), request.error) == (True, b"abc", None)
    assert ended == [request]
    assert line.engine.latency == pytest.approx(0.01)
    assert line.engine.idle
    assert line.engine.next_due() is None


def test_one_request_is_in_flight(line: Line) -> None:
    for command in (1, 2, 3):
        line.engine.request(command)
    for command in (1, 2, 3):
        assert line.commands() == [command]
        line.reply(command)


def test_priorities_order_the_waiting_requests(line: Line) -> None:
    line.engine.request(10)
    assert line.commands() == [10]
    for command, priority in ((4, Priority.BACKGROUND), (3, Priority.NORMAL), (2, Priority.TELEMETRY)):
        line.engine.request(command, priority=priority)
    line.engine.request(200, priority=Priority.CONTROL)
    order = []
    for command in (10, 200, 2, 3, 4):
        line.reply(command)
        order += line.commands()
    assert order == [200, 2, 3, 4]


def test_a_request_that_waits_is_sent_before_fast_polling_but_not_before_control(line: Line) -> None:
    line.engine.request(108, priority=Priority.TELEMETRY)
    line.engine.request(112, priority=Priority.BACKGROUND)
    line.engine.request(92, priority=Priority.BACKGROUND)
    order = line.commands()
    for _ in range(8):
        line.engine.request(108, priority=Priority.TELEMETRY)
        line.wait(MAX_WAIT / 3)
        line.reply(order[-1])
        order += line.commands()
    assert order == [108, 108, 108, 108, 112, 108, 92, 108, 108]
    line.engine.request(200, priority=Priority.CONTROL)
    line.wait(1)
    line.reply(108)
    assert line.commands() == [200]


def test_a_lost_reply_is_requested_again_and_then_an_error(line: Line) -> None:
    request = line.engine.request(108, timeout=0.5, retries=1, name="MSP_ATTITUDE")
    assert line.commands() == [108]
    assert line.engine.next_due() == 0.5
    line.wait(0.5)
    assert line.commands() == [108]
    line.wait(0.5)
    assert line.commands() == []
    with pytest.raises(MspTimeout, match=r"^MSP_ATTITUDE on test failed after 2 attempts: no answer$"):
        request.result()
    assert isinstance(request.error, TimeoutError)


def test_a_reply_in_the_rest_of_a_damaged_frame_is_found_at_the_timeout(line: Line) -> None:
    request = line.engine.request(108, timeout=0.5)
    assert line.commands() == [108]
    line.engine.receive(b"$M>\xc8" + Frame(108, b"ab", Direction.RESPONSE).encode(), line.now)
    assert not request.done
    line.wait(0.5)
    assert line.commands() == []
    assert request.result() == b"ab"


def test_an_error_reply_is_a_refusal(line: Line) -> None:
    request = line.engine.request(0x3000)
    assert [frame.version for frame in line.sent()] == [FrameVersion.V2]
    error = Frame(0x3000, direction=Direction.ERROR, version=FrameVersion.V2)
    line.engine.receive(error.encode(), line.now)
    with pytest.raises(MspDenied, match=r"^MSP command 12288 on test failed: refused by the firmware$"):
        request.result()


def test_the_reply_to_an_earlier_attempt_is_not_taken_for_the_reply_to_the_next_request(line: Line) -> None:
    first = line.engine.request(118, b"\x01", timeout=0.5)
    assert line.commands() == [118]
    line.wait(0.5)
    assert line.commands() == [118]
    line.reply(118, b"waypoint 1")
    assert first.result() == b"waypoint 1"
    second = line.engine.request(118, b"\x02")
    assert line.commands() == [1]  # its reply comes after all earlier ones
    line.reply(118, b"waypoint 1")
    line.reply(1, b"\0\1\x2e")
    assert line.engine.late_replies == 1
    assert line.commands() == [118]
    line.reply(118, b"waypoint 2")
    assert second.result() == b"waypoint 2"


def test_a_request_is_sent_even_if_the_check_for_late_replies_has_no_answer(line: Line) -> None:
    line.engine.request(108, timeout=0.1, retries=0)
    assert line.commands() == [108]
    line.wait(0.1)
    line.engine.request(108)
    assert line.commands() == [1]
    line.wait(0.5)
    assert line.commands() == [108]


def test_a_deadline_ends_waiting_requests_too(line: Line) -> None:
    line.engine.request(1, timeout=10)
    waiting = line.engine.request(2, deadline=0.3)
    assert line.commands() == [1]
    assert line.engine.next_due() == 0.3
    line.wait(0.3)
    line.engine.step(line.now)
    with pytest.raises(MspTimeout, match="the line was busy with other requests"):
        waiting.result()
    current = line.engine.request(3, timeout=10, deadline=1.0)
    line.reply(1)
    assert line.commands() == [3]
    line.wait(0.7)
    assert line.commands() == []
    assert isinstance(current.error, MspTimeout)


def test_requests_are_cancelled(line: Line) -> None:
    current, waiting, other = (line.engine.request(command) for command in (1, 2, 3))
    line.sent()
    line.engine.cancel(current)
    line.engine.cancel(waiting)
    assert line.commands() == [3]
    line.engine.cancel_all("the connection was closed")
    for request in (current, waiting, other):
        with pytest.raises(RemoteCancelled):
            request.result()
    assert line.engine.idle
    line.engine.cancel(other)


def test_a_request_without_reply_ends_when_it_is_sent(line: Line) -> None:
    request = line.engine.request(200, b"ab", flags=NO_REPLY)
    assert line.sent() == [Frame(200, b"ab", version=FrameVersion.V2, flags=NO_REPLY)]
    assert request.result() == b""


def test_unsolicited_frames_are_passed_on(line: Line) -> None:
    seen: list[Frame] = []
    line.engine.unsolicited = seen.append
    line.reply(182, b"\x04")
    line.engine.request(108)
    line.sent()
    line.reply(108, direction=Direction.REQUEST)
    assert [frame.command for frame in seen] == [182, 108]
    assert not line.engine.idle


@pytest.mark.parametrize(
    "options", [{"timeout": 0}, {"retries": -1}, {"payload": bytes(5000)}, {"flags": 300}]
)
def test_refuses_wrong_arguments(line: Line, options: dict[str, object]) -> None:
    with pytest.raises(InvalidArgumentError):
        line.engine.request(1, **options)
    assert line.engine.idle
