from __future__ import annotations

import pytest

from mavstack.cli.common.errors import CommandError
from mavstack.cli.web.passwords import read_passwords
from mavstack.security.roles import Role


def test_one_password_is_that_of_administrators(tmp_path) -> None:
    path = tmp_path / "password"
    path.write_text("correct horse battery\n")
    assert read_passwords(str(path)) == {Role.ADMINISTER: "correct horse battery"}


def test_a_password_for_each_role(tmp_path) -> None:
    path = tmp_path / "passwords"
    path.write_text("# of the field\nobserve  only watching\n\nadminister\tmay do it all\n")
    assert read_passwords(str(path)) == {Role.OBSERVE: "only watching", Role.ADMINISTER: "may do it all"}


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "has no password"),
        ("operate", "entry 1: expected a role"),
        ("operate secret one\npilot secret two\n", "entry 2: expected a role"),
        ("operate secret one\noperate secret two\n", "entry 2: the role operate has two passwords"),
    ],
)
def test_errors_hold_no_password(tmp_path, text, problem) -> None:
    path = tmp_path / "passwords"
    path.write_text(text)
    with pytest.raises(CommandError, match=problem) as caught:
        read_passwords(str(path))
    assert "secret" not in str(caught.value)


def test_a_missing_file() -> None:
    with pytest.raises(CommandError, match=r"cannot open /nowhere/file: No such file"):
        read_passwords("/nowhere/file")
