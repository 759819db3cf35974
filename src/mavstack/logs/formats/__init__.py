"""The built-in formats: signatures, and how a file is opened; its reader is imported then."""
