"""Renaming over FTP: a repetition of an executed rename, and of one without a source."""

from __future__ import annotations

import pytest

from mavstack.services.ftp import FtpClient
from mavstack.services.ftp.payload import FtpError, Opcode
from tests.services.ftp.raw_requests import asked, nak, reply
from tests.services.network import GROUND, START, VEHICLE


@pytest.fixture
def client() -> FtpClient:
    return FtpClient(GROUND, VEHICLE)


@pytest.mark.parametrize(
    ("listing", "renamed"), [(b"Dx\0Fnew\t5\0", True), (b"Fold\t5\0", False), (None, False)]
)
@pytest.mark.parametrize("error", [(FtpError.FILENOTFOUND,), (FtpError.FAILERRNO, 2)], ids=["code", "errno"])
def test_a_repeated_rename_without_a_source_has_worked_if_its_target_exists(
    client, listing, renamed, error
) -> None:
    operation = client.rename("old", "dir/new", START)
    (request,) = asked(client)
    client.handle_timeout(client.next_timeout())
    asked(client)
    nak(client, request, *error)
    (listed,) = asked(client)
    assert (listed.opcode, listed.data) == (Opcode.LISTDIRECTORY, b"dir")
    if listing is None:
        nak(client, listed, FtpError.FILENOTFOUND)
    else:
        reply(client, listed, listing)
        nak(client, asked(client)[0], FtpError.EOF)
    assert operation.done
    assert (operation.error is None) is renamed
    if not renamed:
        assert str(operation.error).startswith("renaming old to dir/new on 1/1 failed after 2 attempts")


def test_the_first_refusal_of_a_rename_is_final(client) -> None:
    operation = client.rename("old", "new", START)
    nak(client, asked(client)[0], FtpError.FILENOTFOUND)
    assert operation.error is not None
    assert asked(client) == []
