"""The records of the schemes of Mavstack: each module has them as `SCHEMES`, and is found by its place."""
