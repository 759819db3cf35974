from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.server.rows.decoder_file import MAX_FILE, read_decoder_file, read_decoders

if TYPE_CHECKING:
    from pathlib import Path

ONE = {"name": "one", "messages": [{"fields": [{"name": "a", "type": "uint8"}]}]}
DASHBOARD = {"type": "mavstack-dashboard", "decoders": [ONE, {"name": "two"}]}


def written(folder: Path, value: object) -> Path:
    path = folder / "file.json"
    path.write_text(value if isinstance(value, str) else json.dumps(value), "utf-8")
    return path


def test_decoders_dashboards_and_projects_have_decoders(tmp_path: Path) -> None:
    assert read_decoder_file(written(tmp_path, {"type": "mavstack-decoder", **ONE})).name == "one"
    assert list(read_decoders(written(tmp_path, DASHBOARD))) == ["one", "two"]
    path = written(tmp_path, {"type": "mavstack-project", "dashboards": [DASHBOARD, {"title": "x"}]})
    assert read_decoder_file(path, "two").name == "two"


@pytest.mark.parametrize(
    ("value", "name", "reason"),
    [
        (DASHBOARD, "", "2 decoders, not one: one, two"),
        (DASHBOARD, "three", "no decoder three: there are one, two"),
        ({"type": "x"}, "", 'its "type" must be one of mavstack-decoder'),
        ({"type": "mavstack-decoder", "colour": 1}, "", "colour is not known here"),
        ("{", "", "it is not JSON"),
        ("[" * 100_000, "", "it is not JSON"),
        ("[]", "", "not a JSON object"),
        (" " * (MAX_FILE + 1), "", "longer than"),
    ],
    ids=["several", "unknown", "type", "malformed", "no JSON", "deep", "list", "long"],
)
def test_files_that_are_no_decoder(tmp_path: Path, value: object, name: str, reason: str) -> None:
    with pytest.raises(InvalidArgumentError, match=r"reading the decoder .* failed: ") as caught:
        read_decoder_file(written(tmp_path, value), name)
    assert reason in str(caught.value)


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InvalidArgumentError, match="No such file"):
        read_decoders(tmp_path / "missing.json")
