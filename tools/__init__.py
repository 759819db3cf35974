"""Development tools: checks that `make test` runs over the sources."""
