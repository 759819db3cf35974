"""C# for .NET Standard 2.0 and later: a class for each message, an enum for each enum, no dependencies."""

from mavstack.codegen.languages.csharp.library_files import LANGUAGE

__all__ = ["LANGUAGE"]
