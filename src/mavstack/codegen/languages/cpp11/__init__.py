"""C++11 and later: typed messages with the names of the official C++ library, over the runtime in C."""

from mavstack.codegen.languages.cpp11.render import LANGUAGE

__all__ = ["LANGUAGE"]
