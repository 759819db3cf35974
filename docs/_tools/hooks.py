"""MkDocs hooks: generated pages, generated parts of pages, and their place in the navigation.

A page holds a generated part where a line reads `[[generated: NAME]]`; NAME is a key of `PARTS`. The message
reference has one to three generated pages per dialect. HTML comments that direct the tests are removed.
"""

from __future__ import annotations

import re
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

ROOT = Path(__file__).parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from mkdocs.structure.files import File  # noqa: E402

from docs._tools import (  # noqa: E402
    api_table,
    bridge_pages,
    cli_pages,
    error_tree,
    link_options,
    message_pages,
    msp_pages,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

#: The generated parts of pages, by the name in the marker line.
PARTS: dict[str, Callable[[], str]] = {
    "api table": api_table.render,
    "command line": cli_pages.render,
    "dialects": message_pages.render_index,
    "error tree": error_tree.render,
    "link options": link_options.render,
    "mqtt commands": bridge_pages.render_mqtt_commands,
    "mqtt topics": bridge_pages.render_mqtt_topics,
    "msp messages": msp_pages.render_messages,
    "msp settings": msp_pages.render_settings,
    "ros differences": bridge_pages.render_differences,
    "ros table": bridge_pages.render_table,
    "top level": api_table.render_top_level,
    "vehicle metrics": bridge_pages.render_metrics,
}
_MARKER = re.compile(r"^\[\[generated: ([a-z ]+)\]\]$", re.MULTILINE)
_TEST_COMMENT = re.compile(r"^ *<!-- (?:test|file|fragment|runnable|shell|skip)\b.*?-->\n", re.MULTILINE)


@cache
def _message_pages() -> list[message_pages.Page]:
    return list(message_pages.pages())


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add the pages of the dialects to the navigation."""
    section: list[Any] = next(entry["Messages"] for entry in config.nav or [] if "Messages" in entry)
    if len(section) == 1:
        section += message_pages.navigation(_message_pages())
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages."""
    for page in _message_pages():
        files.append(File.generated(config, page.path, content=page.text))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Fill in generated parts and remove the comments that direct the tests."""
    return fill_in(_TEST_COMMENT.sub("", markdown))


def fill_in(markdown: str) -> str:
    """Return the text with its generated parts."""
    return _MARKER.sub(lambda match: PARTS[match[1]](), markdown)
