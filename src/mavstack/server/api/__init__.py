"""The routes of the API, one module per subject; each has a table `ROUTES`."""
