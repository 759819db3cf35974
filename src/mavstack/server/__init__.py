"""The server of the browser ground station: a station, its HTTP API and its WebSockets."""
