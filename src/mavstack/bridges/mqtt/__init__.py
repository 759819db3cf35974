"""MQTT: the state, telemetry and events of vehicles as JSON, and commands; Home Assistant by discovery."""
