"""The blocking classes: their names, and the async classes that they wrap."""

from __future__ import annotations

#: Module of each async class that has a blocking counterpart of the same name, relative to `mavstack`.
CLASSES = {
    "Subscription": "node.subscription",
    "Listener": "node.dispatch",
    "Recording": "node.recording",
    "EventStream": "node.events",
    "EventListener": "node.events",
    "CommandHandlers": "node.command_handlers",
    "ControlStream": "node.control",
    "ExtendedParams": "node.extended_params",
    "Camera": "node.camera",
    "CameraSettings": "node.camera_settings",
    "Ftp": "node.ftp",
    "Gimbal": "node.gimbal",
    "Logs": "node.logs",
    "Modes": "node.modes",
    "Params": "node.params",
    "Plans": "node.plans",
    "Shell": "node.shell",
    "Terrain": "node.terrain",
    "RemoteComponent": "node.component",
    "Node": "node.node",
    "MessageStream": "vehicle.telemetry.stream",
    "ValueStream": "vehicle.telemetry.value_stream",
    "GuidedSession": "vehicle.guided_session",
    "VehiclePlan": "vehicle.mission",
    "Mission": "vehicle.mission",
    "Actuators": "vehicle.actuators",
    "CalibrationSession": "vehicle.calibration.session",
    "Calibration": "vehicle.calibration.calibration",
    "RegionOfInterest": "vehicle.roi",
    "Vehicle": "vehicle.vehicle",
    "Results": "vehicle.group",
    "Group": "vehicle.group",
    "Connection": "vehicle.connection",
}
#: Module of each base class whose members belong to the classes above without a name of their own.
MIXINS = {
    "ReadOnly": "node.read_only",
    "Messaging": "node.messaging",
    "CameraActions": "node.camera_actions",
    "PayloadParts": "node.payloads",
    "PlanParts": "node.plans",
    "EventParts": "node.events",
    "ControlStreams": "node.control_streams",
    "SenderChoice": "node.sender_choice",
    "Serving": "node.serving",
    "VehiclePayloads": "vehicle.payloads",
    "TelemetryProperties": "vehicle.telemetry.properties",
    "TelemetryStreams": "vehicle.telemetry.value_streams",
    "FlightActions": "vehicle.flight",
    "VehicleState": "vehicle.vehicle_state",
}
#: Module of the functions of the blocking API.
FUNCTIONS = {"connect": "vehicle.connection"}
