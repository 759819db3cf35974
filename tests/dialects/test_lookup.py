from __future__ import annotations

import pytest

from mavstack.dialects import Dialect
from mavstack.dialects.lookup import find_dialect
from mavstack.errors import UnknownDialectError

DEFINITION = (
    '<mavlink><messages><message id="1" name="M"><field type="uint8_t" name="f"/></message>'
    "</messages></mavlink>"
)


def test_a_name_is_an_official_dialect():
    assert find_dialect(" Common ") is Dialect.load("common")
    with pytest.raises(UnknownDialectError):
        find_dialect("nothing")


def test_a_path_is_a_file(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "Own.XML").write_text(DEFINITION)
    assert find_dialect("~/Own.XML").names == ("M",)
    with pytest.raises(UnknownDialectError, match="no such file"):
        find_dialect(str(tmp_path / "gone.xml"))
