from tests.codegen.languages_for_tests import plugins

__all__ = ["plugins"]
