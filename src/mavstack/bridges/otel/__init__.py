"""OpenTelemetry: spans of operations, and metrics of vehicles, by OTLP over HTTP."""
