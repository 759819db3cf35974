"""The generated parts of the documentation are complete, and the navigation names pages that exist."""

from __future__ import annotations

import re
from importlib import import_module

import pytest

from docs._tools import api_table, bridge_pages, error_tree, link_options, message_pages, msp_pages
from mavstack import Dialect
from mavstack.bridges.core.metrics import METRICS
from mavstack.bridges.core.table import ALL
from mavstack.bridges.mqtt.verbs import VERBS
from mavstack.links.scheme_table import builtin_schemes
from mavstack.msp.messages.fields import layout_of
from mavstack.msp.messages.registry import all_messages
from mavstack.msp.settings.tables import ALL_SETTINGS
from tests.docs.blocks import DOCS, ROOT

BUILTIN = builtin_schemes()
PAGES = list(message_pages.pages())


def pages_of(name: str) -> str:
    return "\n".join(page.text for page in PAGES if page.dialect == name).replace("<wbr>", "")


@pytest.mark.parametrize("name", message_pages.ordered_names())
def test_a_dialect_lists_its_messages_commands_and_enums(name):
    text, definition = pages_of(name), Dialect.load(name).own_definition
    for message in definition.messages:
        assert f"{{ #{message.name} }}" in text
        assert all(f"<code>{field.name}</code>" in text for field in message.fields)
    for enum in definition.enums:
        assert all(entry.name in text for entry in enum.entries)


def test_links_between_message_pages_lead_to_anchors():
    anchors = {page.path: set(re.findall(r"{ #(\w+) }", page.text)) for page in PAGES}
    for page in PAGES:
        folder = page.path.removesuffix("index.md").removesuffix(".md").rstrip("/")
        for target, anchor in re.findall(r'href="([^"#]+)#?(\w*)"', page.text):
            parts = folder.split("/")
            for part in target.rstrip("/").split("/"):
                parts = parts[:-1] if part == ".." else [*parts, part]
            path = "/".join(parts)
            found = anchors.get(f"{path}.md", anchors.get(f"{path}/index.md"))
            assert found is not None, (page.path, target)
            assert not anchor or anchor in found, (page.path, target, anchor)


def test_the_table_of_schemes_has_every_scheme():
    text = link_options.render()
    assert all(f"| `{each.name}` | `{each.example}` | {each.purpose} |" in text for each in BUILTIN.values())


@pytest.mark.parametrize("scheme", BUILTIN.values(), ids=lambda each: each.name)
def test_the_record_of_a_scheme_has_the_options_that_its_backend_reads(scheme):
    read = set(link_options.options_of(scheme.name))
    assert read - set(link_options.DESCRIPTIONS) == set(scheme.options)


def test_every_common_option_exists():
    common = set(link_options.options_of("file")) & set(link_options.DESCRIPTIONS)
    assert common | set(link_options.impairment_options()) == set(link_options.DESCRIPTIONS)


def test_the_msp_reference_holds_every_message_and_setting():
    text = msp_pages.render_messages()
    for message in all_messages():
        assert f"{{ #{message.__name__} }}" in text
        assert f"`{message.NAME}` ({message.COMMAND})" in text
        assert all(f"<code>{field}</code>" in text for field in layout_of(message))
    settings = msp_pages.render_settings().replace("<wbr>", "")
    for item in ALL_SETTINGS:
        assert all(f"<code>{name}</code>" in settings for name in (item.name, *item.aliases))
        assert f"<td>{item.type.name}</td>" in settings


def test_the_error_tree_holds_every_error():
    text = error_tree.render()
    errors = error_tree.all_errors()
    assert len(errors) > 30
    assert all(f"`{error.__name__}`" in text for error in errors)


def test_the_api_table_holds_every_public_class():
    text = api_table.render()
    for section in api_table.SECTIONS:
        for name, _ in api_table.public_names(section):
            assert re.search(rf"^### {name}$|`{name}[`(]", text, re.MULTILINE), name


@pytest.mark.parametrize(
    "method", ["takeoff(altitude=10.0, *", "wait_for_vehicle(system=None, *", "goto(latitude, longitude"]
)
def test_the_api_table_shows_arguments_and_defaults(method):
    assert f"`{method}" in api_table.render()


def test_the_navigation_names_every_page():
    named = set(re.findall(r"[\w/-]+\.md", (ROOT / "mkdocs.yml").read_text("utf-8")))
    assert named == {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md")}


def test_markers_name_generated_parts():
    hooks = import_module("docs._tools.hooks")
    for path in DOCS.rglob("*.md"):
        for name in re.findall(r"^\[\[generated: (.*)\]\]$", path.read_text("utf-8"), re.MULTILINE):
            assert name in hooks.PARTS, (path, name)


def test_the_api_reference_names_objects_that_exist():
    for path in (DOCS / "reference").rglob("*.md"):
        text = path.read_text("utf-8")
        for identifier, options in re.findall(r"^::: ([\w.]+)\n((?: +.*\n)*)", text, re.MULTILINE):
            item = found(identifier)
            members = re.search(r"members: \[(.*)\]", options)
            for name in members[1].split(", ") if members else ():
                assert hasattr(item, name), f"{path.name}: {identifier}.{name}"


def found(identifier: str) -> object:
    """The module or class of a dotted name."""
    item: object = import_module("mavstack")
    names = identifier.split(".")
    for index, name in enumerate(names[1:], 2):
        if not hasattr(item, name):
            import_module(".".join(names[:index]))
        item = getattr(item, name)
    return item


def test_the_api_reference_holds_the_public_names_of_a_connection_and_a_node():
    for package in ("vehicle", "node"):
        text = (DOCS / "reference" / "api" / f"{package}.md").read_text("utf-8")
        for name in import_module(f"mavstack.{package}").__all__:
            assert re.search(rf"\b{name}\b", text), name


def test_measured_figures_are_those_of_the_benchmarks():
    page = (DOCS / "explanation" / "performance.md").read_text("utf-8")
    measured = page[page.index("## Live telemetry") : page.index("## Simulated vehicles")]
    benchmarks = (ROOT / "benchmarks" / "README.md").read_text("utf-8")
    figures = re.findall(r"\d+[.,]\d+", measured)
    assert len(figures) > 40
    assert [figure for figure in figures if figure not in benchmarks] == []


def test_the_table_of_ros_has_every_row():
    text = bridge_pages.render_table()
    assert all(f"| `{row.name}` | " in text for row in ALL)
    assert (
        "| `setpoint_velocity/cmd_vel` | the frame is that of the header" in bridge_pages.render_differences()
    )


def test_the_guide_of_prometheus_has_every_metric():
    text = import_module("docs._tools.hooks").fill_in((DOCS / "guides" / "grafana.md").read_text("utf-8"))
    assert all(f"| `{metric.name}` | {metric.text} |" in text for metric in METRICS)


def test_the_guide_of_mqtt_has_every_command_with_its_arguments():
    text = import_module("docs._tools.hooks").fill_in((DOCS / "guides" / "mqtt.md").read_text("utf-8"))
    for name, verb in VERBS.items():
        (line,) = re.findall(rf"^\| `{name}` \|.*$", text, re.MULTILINE)
        assert all(f"`{argument}`" in line for argument in (*verb.needed, *verb.optional))
        assert verb.role.word in line
