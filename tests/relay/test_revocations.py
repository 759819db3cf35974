from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.relay.revocations import Revocations, revoke
from mavstack.security.room_tickets import Seat

from .harness import ticket

if TYPE_CHECKING:
    from pathlib import Path


def test_a_file_that_changes_is_read_again(tmp_path: Path) -> None:
    path, one, other = tmp_path / "revoked.txt", ticket(Seat.GUEST), ticket(Seat.HOST)
    revocations = Revocations(path)
    assert not revocations.has(one)
    assert revoke(one, path)
    assert not revoke(one, path)
    assert revocations.read()
    assert not revocations.read()
    assert revocations.has(one)
    assert not revocations.has(other)
    assert one not in path.read_text("ascii")
    path.unlink()
    assert revocations.read()
    assert not revocations.has(one)


def test_what_cannot_be_read_changes_nothing(tmp_path: Path) -> None:
    path, one = tmp_path / "revoked.txt", ticket(Seat.GUEST)
    revoke(one, path)
    revocations = Revocations(path)
    path.write_text("# comment\n\nnonsense\n", "ascii")
    with pytest.raises(LinkError, match="line 3 is not a digest"):
        revocations.read()
    assert revocations.has(one)
    with pytest.raises(LinkError, match="Is a directory"):
        Revocations(tmp_path)


def test_a_malformed_file_is_reported_once(tmp_path: Path) -> None:
    path = tmp_path / "revoked.txt"
    revocations = Revocations(path)
    path.write_text("nonsense\n", "ascii")
    with pytest.raises(LinkError):
        revocations.read()
    assert not revocations.read()


def test_a_file_that_is_too_long_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "revoked.txt"
    revoke(ticket(Seat.GUEST), path)
    monkeypatch.setattr("mavstack.relay.revocations.MAX_FILE", path.stat().st_size - 1)
    with pytest.raises(LinkError, match="longer than"):
        Revocations(path)


def test_a_ticket_is_added_after_an_incomplete_last_line(tmp_path: Path) -> None:
    path, one = tmp_path / "revoked.txt", ticket(Seat.GUEST)
    path.write_text("# a comment without a line break", "ascii")
    revoke(one, path)
    assert Revocations(path).has(one)


def test_texts_that_are_no_ticket_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidArgumentError, match="not a ticket"):
        revoke("room1.boat", tmp_path / "revoked.txt")
    with pytest.raises(InvalidArgumentError, match="writing"):
        revoke(ticket(Seat.GUEST), tmp_path / "missing" / "revoked.txt")


def test_no_file_revokes_nothing() -> None:
    assert not Revocations(None).read()
    assert not Revocations(None).has(ticket(Seat.GUEST))
