"""The pages about the router: valid configurations, a complete reference, commands that are understood."""

from __future__ import annotations

import re
import shlex
from dataclasses import fields

import pytest

from mavstack.cli.registry import command_parser
from mavstack.cli.route import command
from mavstack.router.config import PacketFilter, Table, parse_config
from mavstack.router.guard import check_firewall
from tests.cli.route.test_command import FakeClient
from tests.docs.blocks import BLOCKS, DOCS

CONFIGS = [block for block in BLOCKS if block.language == "toml" and "[endpoint." in block.text]
LINES = [
    line
    for block in BLOCKS
    if block.language == "sh"
    for line in block.text.splitlines()
    if line.startswith("mav route ")
]
PAGE = (DOCS / "reference" / "router.md").read_text("utf-8")
#: A configuration in which every table is read.
TEXT = "[router]\n[endpoint.x]\nurl = 'udpout://127.0.0.1:1'\n[endpoint.x.in]\n[endpoint.x.out]\n"


@pytest.mark.parametrize("block", CONFIGS, ids=lambda block: block.name)
def test_configurations_are_valid(block, monkeypatch):
    monkeypatch.setattr("mavstack.router.config.signing._find_key", lambda name: None)  # the reader's keys
    config = parse_config(block.text, block.page)
    assert config.endpoints
    check_firewall(config)


def keys_of(heading):
    """The keys in the table below a heading of the reference."""
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return set(re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE))


@pytest.mark.parametrize(
    ("heading", "table"),
    [
        ("`[router]`", ("router",)),
        ("`[endpoint.NAME]`", ("endpoint", "x")),
        ("`[endpoint.NAME.in]` and `[endpoint.NAME.out]`", ("endpoint", "x", "in")),
    ],
)
def test_the_reference_has_every_key(monkeypatch, heading, table):
    known = {}
    finish = Table.finish

    def finish_and_keep(self):
        known[self.keys] = set(self._known)
        finish(self)

    monkeypatch.setattr(Table, "finish", finish_and_keep)
    parse_config(TEXT)
    assert keys_of(heading) == known[table]


def test_filters_have_the_keys_of_the_reference():
    assert {each.name for each in fields(PacketFilter)} == keys_of(
        "`[endpoint.NAME.in]` and `[endpoint.NAME.out]`"
    )


@pytest.mark.parametrize("line", [line for line in LINES if " ctl " in line])
def test_control_commands_run(monkeypatch, capsys, line):
    monkeypatch.setattr("mavstack.cli.route.control.ControlClient", FakeClient)
    assert command.run(arguments_of(line)) == 0
    assert FakeClient.last.calls


@pytest.mark.parametrize("line", [line for line in LINES if " -e " in line])
def test_links_of_commands_are_valid(monkeypatch, line):
    if "key=" in line:  # the reader's own key
        monkeypatch.setattr(command, "open_link", str)
        monkeypatch.setattr(command, "check_link_settings", lambda link: None)
    config, _ = command._config(arguments_of(line))
    assert len(config.endpoints) == line.count(" -e ")


def arguments_of(line):
    words = shlex.split(line.partition(" > ")[0], comments=True)[2:]
    return command_parser("route").parse_args(words)
