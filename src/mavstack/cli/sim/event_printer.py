"""The events of a simulation, printed one line each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.output import echo, echo_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.links import Link
    from mavstack.sim.faults import TimedFault
    from mavstack.sim.msp import SimulatedFlightController
    from mavstack.sim.vehicle import SimulatedVehicle


class EventPrinter:
    """Prints the events of a simulation, one line each."""

    def __init__(self, as_json: bool) -> None:
        self._json = as_json
        self._started = 0.0

    def begin(
        self, vehicles: Sequence[SimulatedVehicle | SimulatedFlightController], links: Sequence[str]
    ) -> None:
        """Print the vehicles and the URLs of their links."""
        self._started = vehicles[0].now
        if self._json:
            self._print(
                "ready",
                vehicles=[
                    {"system": each.address.system, "type": each.vehicle_type, "firmware": each.firmware}
                    for each in vehicles
                ],
                links=list(links),
            )
            return
        for vehicle in vehicles:
            equipment = vehicle.equipment
            shown = f" with {', '.join(equipment)}" if equipment else ""
            echo(f"system {vehicle.address.system}: {vehicle.firmware} {vehicle.vehicle_type}{shown}")
        echo("on " + (", ".join(links) if len(links) <= 6 else f"{links[0]} … {links[-1]}"))
        echo(_input_hint())

    def event(self, vehicle: SimulatedVehicle | SimulatedFlightController, kind: str, text: str) -> None:
        """Print an event of a vehicle."""
        system, elapsed = vehicle.address.system, vehicle.now - self._started
        if self._json:
            self._print(kind, time=round(elapsed, 2), system=system, text=text)
        else:
            echo(f"{elapsed:8.1f}  {system:3}  {text}")

    def fault(self, injected: TimedFault, elapsed: float) -> None:
        """Print an injected fault."""
        if self._json:
            fields = {"system": injected.system, "text": injected.fault.text}
            self._print("fault", time=round(elapsed, 2), **fields)
        else:
            target = injected.system or "all"
            echo(f"{elapsed:8.1f}  {target:3}  FAULT {injected.fault.text}")

    def link_down(self, link: Link, reason: str) -> None:
        """Print that a link has no connection."""
        echo(f"mav sim: {link.url.redacted}: {reason}", error=True)

    def _print(self, event: str, **fields: object) -> None:
        echo_json({"event": event, **fields})


def _input_hint() -> str:
    from mavstack.cli.common.stdin_lines import is_in_background

    fault = "a fault (gps off, battery 15, link off, reboot …)"
    if is_in_background():
        return f"running in the background; to type {fault} or Ctrl-C, bring it to the foreground (fg)"
    return f"type {fault}, or Ctrl-C to end"
