"""Prometheus: metrics of vehicles, read at each scrape; a dashboard for Grafana and rules for alerts."""
