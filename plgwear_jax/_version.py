"""The version, apart from all that takes time to import."""

__all__ = ["__version__"]

__version__ = "0.1.0"
