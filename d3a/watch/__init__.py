"""Recordings that grow while they are taken in: folders that are written to, and live robots."""

from d3a.watch.patience import Patience
from d3a.watch.rosbridge import is_address
from d3a.watch.run import Watching, watch
from d3a.watch.sources import follow

__all__ = ["Patience", "Watching", "follow", "is_address", "watch"]
