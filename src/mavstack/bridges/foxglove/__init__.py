"""Foxglove: a WebSocket server with the topics, services and parameters of vehicles."""
