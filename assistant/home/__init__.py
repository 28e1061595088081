"""The demo home: a small recording that ships with the product, and the script that renders it."""

from assistant.home.folder import recording_folder

__all__ = ["recording_folder"]
