"""Code blocks and table cells of the documentation, with the comments that say how to check them.

A comment in the line above a block directs the tests:

    <!-- fragment -->            Python that stands inside a coroutine: type-checked
    <!-- fragment: module -->    Python that stands at the top of a module: type-checked
    <!-- test: pytest -->        a test module: run by pytest
    <!-- test: endless -->       a program that runs until it is ended: it must print something
    <!-- cell -->                a cell of a notebook: run in a kernel, after the cells above it
    <!-- file: NAME -->          the block is a file beside the page's programs
    <!-- shell commands -->      commands of `mav shell`
    <!-- runnable -->            shell lines that are run against a simulated vehicle
    <!-- skip: REASON -->        not checked

A Python block without a comment is a program: type-checked and run. Shell lines that begin with `mav` are
parsed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
_BLOCK = re.compile(
    r"(?:^<!-- (?P<directive>[^>]*?) -->\n)?^```(?P<language>\w+)[^\n]*\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
_CODE = re.compile(r"`([^`]+)`")


@dataclass(frozen=True)
class Block:
    """One fenced block."""

    page: str
    line: int
    language: str
    directive: str
    text: str

    @property
    def name(self) -> str:
        """The page and line, as an id of tests and as the name of a module."""
        return re.sub(r"\W+", "_", f"{self.page.removesuffix('.md')}_{self.line}")

    @property
    def skipped(self) -> bool:
        return self.directive.startswith("skip:")

    @property
    def is_fragment(self) -> bool:
        return self.directive.startswith("fragment")

    @property
    def is_program(self) -> bool:
        return self.language == "python" and (not self.directive or self.directive == "test: endless")

    @property
    def needs_vehicle(self) -> bool:
        return "udpin://0.0.0.0" in self.text


def pages() -> list[Path]:
    return sorted(path for path in DOCS.rglob("*.md") if "_tools" not in path.parts)


def blocks_of(path: Path) -> list[Block]:
    text = path.read_text("utf-8")
    page = str(path.relative_to(DOCS))
    return [
        Block(
            page,
            text.count("\n", 0, found.start()) + 1,
            found["language"],
            found["directive"] or "",
            found["text"],
        )
        for found in _BLOCK.finditer(text)
    ]


BLOCKS = [block for path in pages() for block in blocks_of(path)]


@dataclass(frozen=True)
class Row:
    """One row of a comparison table: the code on both sides."""

    page: str
    line: int
    theirs: tuple[str, ...]
    ours: tuple[str, ...]


def comparison_rows(page: str) -> list[Row]:
    """The rows of the tables of a page of `coming-from`."""
    rows = []
    lines = (DOCS / "coming-from" / page).read_text("utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if line.startswith("| ") and len(cells) == 2 and "`" in cells[0]:
            rows.append(Row(page, number, tuple(_CODE.findall(cells[0])), tuple(_CODE.findall(cells[1]))))
    return rows
