"""The built-in languages: a package for each, with its names and types, and its templates beside them."""
