"""The rules of the analysis: small functions that look for one kind of fault in a flight.

A rule takes a `Flight` and yields findings with the numbers that it measured. It yields nothing where the log
does not hold what it needs. Other packages add rules by entry points of the group `mavstack.analysis_rules`:
the entry point loads a `Rule`. One that cannot be loaded is left out, with a warning.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from math import inf
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError
from mavstack.plugins import Registry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from importlib.metadata import EntryPoint

    from mavstack.logs.analysis.findings import Finding
    from mavstack.logs.analysis.flight import Flight

ENTRY_POINTS: Final = "mavstack.analysis_rules"


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule.

    Attributes:
        name: Name, as in its findings.
        description: What the rule looks for, its limits, and their source.
        check: Yields the findings of a flight.
    """

    name: str
    description: str
    check: Callable[[Flight], Iterable[Finding]]


#: Modules below `mavstack.logs.analysis` whose `RULES` are the built-in rules.
_MODULES: Final = ("vibration", "navigation", "power", "outputs", "radio_link", "events")


def _builtin() -> dict[str, Rule]:
    modules = (import_module(f"mavstack.logs.analysis.{name}") for name in _MODULES)
    return {rule.name: rule for module in modules for rule in module.RULES}


def _plugin_rule(entry: EntryPoint, loaded: Any) -> Rule:  # noqa: ANN401 - of another package
    if not isinstance(loaded, Rule):
        raise InvalidArgumentError(f"{entry.value} is a {type(loaded).__name__}, not a Rule")
    return loaded


_REGISTRY: Final[Registry[Rule]] = Registry("rule", ENTRY_POINTS, objects=_builtin, convert=_plugin_rule)


def all_rules() -> tuple[Rule, ...]:
    """Return all rules, those of other packages included."""
    return tuple(rule for _, rule in _REGISTRY.items())


def analyse(flight: Flight, rules: Sequence[Rule] | None = None) -> list[Finding]:
    """Apply rules to a flight.

    Args:
        flight: The flight.
        rules: The rules; None for all.

    Returns:
        The findings, the gravest first, then by time.

    Raises:
        LogError: The log cannot be read.
    """
    chosen = all_rules() if rules is None else rules
    findings = [finding for rule in chosen for finding in rule.check(flight)]
    return sorted(
        findings, key=lambda finding: (-finding.severity, inf if finding.time is None else finding.time)
    )
