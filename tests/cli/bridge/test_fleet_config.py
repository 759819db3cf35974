from __future__ import annotations

import json
import shlex
from typing import TYPE_CHECKING

import pytest

from mavstack.cli.bridge.fleet_config import EXAMPLES
from mavstack.cli.main import main

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_write_a_fleet(
    example: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("cryptography")
    monkeypatch.chdir(tmp_path)
    assert main(shlex.split(example)[1:]) == 0
    written = capsys.readouterr().out.splitlines()
    assert written[-1] == str(tmp_path / "fleet" / "router.json5")
    config = json.loads((tmp_path / "fleet" / "router.json5").read_text("utf-8"))
    tls = config["transport"]["link"]["tls"]
    assert all(
        (tmp_path / "fleet" / name).exists()
        for name in ("ca.pem", "alpha.pem", "boat.pem")
        if name in example
    )
    assert tls["listen_certificate"] == str(tmp_path / "fleet" / "router.pem")


@pytest.mark.parametrize(
    ("words", "code", "problem"),
    [
        ([], 1, "a fleet needs vehicles: --vehicle NAME"),
        (["--gateway", "boat"], 2, "must be NAME=VEHICLES"),
        (["--vehicle", "a/b"], 2, "a name must have letters"),
        (["--vehicle", "a", "--pilot", "a"], 1, "the certificate 'a' has two roles"),
    ],
)
def test_wrong_usage(
    words: list[str], code: int, problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bridge", "zenoh", "config", str(tmp_path / "fleet"), *words]) == code
    assert problem in capsys.readouterr().err
    assert not (tmp_path / "fleet").exists()
