"""Run all attacks and print the table; exit code 1 if anything passed ours."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from tools.attacks.gates import GATES
from tools.attacks.lockouts import LOCKOUTS
from tools.attacks.range import opened
from tools.attacks.reloads import RELOADS, UNSIGNED_RELOADS
from tools.attacks.routers import RouterProgram, available, with_gates, without_firewall, without_signing
from tools.attacks.scenarios import FACTORS, FLOOD, PASSED, PLAIN, UNSIGNED, flood
from tools.attacks.station import DELAYS, PROCESSOR_TIME, STATION, delays, opened_station
from tools.attacks.texts import FORMULAS_ROW, TEXTS, formulas
from tools.attacks.vehicles import VEHICLES
from tools.child_processes import end_children_with_this_process

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from tools.attacks.range import Range


def main() -> int:
    """Run the attacks.

    Returns:
        0 if nothing unauthorised passed ours.
    """
    parser = argparse.ArgumentParser(prog="python -m tools.attacks", description=__doc__)
    parser.add_argument("--router", action="append", default=[], help="only this router; may be repeated")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--no-flood", action="store_true", help="leave the flood out")
    arguments = parser.parse_args()
    end_children_with_this_process()
    results: dict[str, dict[str, float]] = {}
    for program in available(arguments.router):
        results[program.name] = attack(program, with_flood=not arguments.no_flood)
        if program.name == "mavstack":
            results[program.name] |= _attack_ours(program)
    if not arguments.router:
        _add_texts(results)
    print(json.dumps(results, indent=2) if arguments.json else _table(results))
    return int(_total(results.get("mavstack", {})) > 0)


def attack(program: RouterProgram, *, with_flood: bool = True) -> dict[str, float]:
    """Run the attacks that all routers have on one router.

    Args:
        program: The router.
        with_flood: Measure the flood too.

    Returns:
        Packets that passed, by attack; for the flood milliseconds.
    """
    results = _run(program, PASSED)
    results |= _run(without_signing(program), UNSIGNED, signed=False)
    results |= _run(without_firewall(program), {**PLAIN, **FACTORS}, signed=False)
    if with_flood:
        with opened(program) as field:
            results |= flood(field)
    return results


def _attack_ours(program: RouterProgram) -> dict[str, float]:
    """Run the attacks on what the other routers do not have."""
    results = _run(with_gates(), {**GATES, **LOCKOUTS})
    results |= _run(program, RELOADS)
    results |= _run(without_signing(program), UNSIGNED_RELOADS, signed=False)
    results |= {name: scenario() for name, scenario in VEHICLES.items()}
    with opened_station() as station:
        results |= delays(station)
        results |= {name: scenario(station) for name, scenario in STATION.items()}
    return results


def _add_texts(results: dict[str, dict[str, float]]) -> None:
    for name, command in TEXTS.items():
        count = formulas(command)
        if count is not None:
            results.setdefault(name, {})[FORMULAS_ROW] = count


def _run(
    program: RouterProgram, attacks: Mapping[str, Callable[[Range], float]], *, signed: bool = True
) -> dict[str, float]:
    """Run each attack on a fresh router."""
    results: dict[str, float] = {}
    for name, scenario in attacks.items():
        with opened(program, signed=signed) as field:
            if not field.command_works():
                raise SystemExit(f"{program.name}: the pilot's own command does not arrive")
            results[name] = scenario(field)
    return results


def _total(results: dict[str, float]) -> float:
    return sum(value for name, value in results.items() if not _is_time(name) and name not in FACTORS)


def _is_time(name: str) -> bool:
    """Return whether a figure is in milliseconds."""
    return name in FLOOD or name in DELAYS or name.endswith(PROCESSOR_TIME)


def _table(results: dict[str, dict[str, float]]) -> str:
    names = list(dict.fromkeys(name for values in results.values() for name in values))
    lines = [f"{'packets that passed':60}" + "".join(f"{router:>16}" for router in results)]
    lines += [_row(name, [values.get(name) for values in results.values()]) for name in names]
    lines.append(_row("unauthorised packets that passed", [_total(each) for each in results.values()]))
    return "\n".join(lines)


def _row(name: str, values: Sequence[float | None]) -> str:
    unit = " ms" if _is_time(name) else ""
    return f"{name:60}" + "".join(f"{'-' if each is None else f'{each:g}{unit}':>16}" for each in values)


if __name__ == "__main__":
    raise SystemExit(main())
