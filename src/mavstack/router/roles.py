"""The rules of an endpoint whose clients have a role (see `mavstack.security.roles`)."""

from __future__ import annotations

from mavstack.dialects import Dialect
from mavstack.router.rules import Action, Rule, RuleSet
from mavstack.security.roles import COMMAND_MESSAGES, Role, command_ids, message_ids


def rules_of(role: Role, *, mission_items: Action = "inspect") -> RuleSet:
    """Return the rules for packets that come from clients with a role; packets to them are not limited.

    Args:
        role: The role.
        mission_items: What happens to the items of a mission if the role may send them: each carries a
            command, which rules cannot compare. The program decides by `allows`, or the link of the clients
            has removed the others already (`role=` in its URL) and they may pass.

    Returns:
        The rules.
    """
    if role is Role.ADMINISTER:
        return RuleSet()
    dialect = Dialect.load("common")
    long, as_int, *items = (dialect[name].definition.id for name in COMMAND_MESSAGES)
    allowed = message_ids(role)
    name = f"role {role.word}"
    rules = [
        Rule("pass", messages=frozenset({long, as_int}), commands=command_ids(role), name=name),
        Rule("pass", messages=allowed - {long, as_int, *items}, name=name),
    ]
    if allowed.issuperset(items):
        rules.append(Rule(mission_items, messages=frozenset(items), name=f"{name}: mission items"))
    return RuleSet(incoming=tuple(rules), default_incoming="drop")
