"""The control of a running router over HTTP, and its metrics."""
