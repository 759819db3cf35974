"""Home Assistant finds vehicles by itself: the retained description of a vehicle as a device.

One message per vehicle on `homeassistant/device/<id>/config`, as Home Assistant reads it since 2024.11.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Home Assistant's default prefix of discovery topics.
DEFAULT_PREFIX: Final = "homeassistant"
#: Sensors: name, group, key, unit, device class.
_SENSORS: Final = (
    ("Battery", "battery", "remaining", "%", "battery"),
    ("Battery voltage", "battery", "voltage", "V", "voltage"),
    ("Battery current", "battery", "current", "A", "current"),
    ("Altitude above home", "position", "relative_altitude", "m", "distance"),
    ("Altitude", "position", "altitude", "m", "distance"),
    ("Ground speed", "speed", "ground_speed", "m/s", "speed"),
    ("Climb rate", "speed", "climb_rate", "m/s", "speed"),
    ("Heading", "position", "heading", "°", None),
    ("Satellites", "gps", "satellites", None, None),
)
_BUTTONS: Final = (
    ("Arm", "arm", "mdi:engine"),
    ("Disarm", "disarm", "mdi:engine-off"),
    ("Hold", "hold", "mdi:pause"),
    ("Land", "land", "mdi:airplane-landing"),
    ("Return", "rtl", "mdi:home-import-outline"),
)


def discovery_topic(prefix: str, identity: str) -> str:
    """Return the topic of a vehicle's description."""
    return f"{prefix}/device/{identity}/config"


def description(
    base: str, identity: str, name: str, *, model: str, modes: Sequence[str] = (), control: bool = False
) -> dict[str, Any]:
    """Return the description of a vehicle.

    Args:
        base: The beginning of its topics, such as "mavstack/uav1".
        identity: Its id in Home Assistant, such as "mavstack_uav1".
        name: Its name for people.
        model: Its firmware and type.
        modes: The names of its flight modes.
        control: Buttons and modes can be used.

    Returns:
        The payload of the discovery.
    """
    components = _observed(base, identity)
    if control:
        components |= _controls(base, identity, modes)
    return {
        "device": {"identifiers": [identity], "name": name, "manufacturer": "MAVLink", "model": model},
        "origin": {"name": "Mavstack", "url": "https://mavlink.io"},
        "availability_topic": f"{base}/status",
        # No common `state_topic`: a tracker takes each text of it as the name of a place.
        "qos": 0,
        "components": components,
    }


def _observed(base: str, identity: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, group, key, unit, device_class in _SENSORS:
        optional = {"unit_of_measurement": unit, "device_class": device_class}
        found[f"{group}_{key}"] = {
            "platform": "sensor",
            "name": name,
            "unique_id": f"{identity}_{group}_{key}",
            "state_topic": f"{base}/telemetry/{group}",
            "value_template": f"{{{{ value_json.{key} }}}}",
            **({"state_class": "measurement"} if unit else {}),
            **{key: value for key, value in optional.items() if value},
        }
    found["mode"] = {
        "platform": "sensor",
        "name": "Flight mode",
        "unique_id": f"{identity}_mode",
        "state_topic": f"{base}/state",
        "value_template": "{{ value_json.mode }}",
    }
    found["armed"] = _flag(base, identity, "Armed", "armed", "safety")
    found["ready"] = {
        **_flag(base, identity, "Ready to arm", "ready", None),
        "json_attributes_topic": f"{base}/state",
        "json_attributes_template": "{{ {'problems': value_json.problems} | tojson }}",
    }
    found["place"] = {
        "platform": "device_tracker",
        "name": "Place",
        "unique_id": f"{identity}_place",
        "json_attributes_topic": f"{base}/telemetry/position",
        "source_type": "gps",
    }
    found["text"] = {
        "platform": "sensor",
        "name": "Last message",
        "unique_id": f"{identity}_text",
        "state_topic": f"{base}/event/text",
        "value_template": "{{ value_json.text[:255] }}",
    }
    return found


def _flag(base: str, identity: str, name: str, key: str, device_class: str | None) -> dict[str, Any]:
    return {
        "platform": "binary_sensor",
        "name": name,
        "unique_id": f"{identity}_{key}",
        "state_topic": f"{base}/state",
        "value_template": f"{{{{ 'ON' if value_json.{key} else 'OFF' }}}}",
        **({"device_class": device_class} if device_class else {}),
    }


def _controls(base: str, identity: str, modes: Sequence[str]) -> dict[str, Any]:
    found: dict[str, Any] = {
        f"button_{verb}": {
            "platform": "button",
            "name": name,
            "unique_id": f"{identity}_button_{verb}",
            "command_topic": f"{base}/cmd/{verb}",
            "payload_press": "{}",
            "icon": icon,
        }
        for name, verb, icon in _BUTTONS
    }
    if modes:
        found["select_mode"] = {
            "platform": "select",
            "name": "Change the mode",
            "unique_id": f"{identity}_select_mode",
            "command_topic": f"{base}/cmd/mode",
            "command_template": '{"mode": {{ value | tojson }}}',
            "state_topic": f"{base}/state",
            "value_template": "{{ value_json.mode }}",
            "options": list(modes),
        }
    return found
