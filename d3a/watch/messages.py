"""ROS messages as rosbridge writes them in JSON, in the form that bags have them."""

from __future__ import annotations

import base64
import binascii
from types import SimpleNamespace
from typing import Any

_BYTES = ("encoding", "format")
"""What stands beside `data` where that is bytes: of an Image, or a CompressedImage."""


def message_of(record: Any) -> Any:
    """Return a message with fields for a JSON object; bytes are decoded, numbers stay numbers.

    JSON has no numbers that are not finite: rosbridge writes null for them.
    """
    if isinstance(record, list):
        return [message_of(each) for each in record]
    if not isinstance(record, dict):
        return float("nan") if record is None else record
    fields = {name: message_of(value) for name, value in record.items()}
    if "data" in fields and any(name in fields for name in _BYTES):
        fields["data"] = _bytes(fields["data"])
    return SimpleNamespace(**fields)


def _bytes(data: Any) -> bytes:
    """Return what rosbridge writes as base64, or as numbers; b"" for what is neither.

    The picture is then counted as broken.
    """
    try:
        return bytes(data) if isinstance(data, list) else base64.b64decode(data, validate=True)
    except (binascii.Error, TypeError, ValueError):
        return b""


def stamp_ns(header: Any) -> int:
    """Return a header's time in nanoseconds: ROS 2 has sec and nanosec, ROS 1 secs and nsecs."""
    stamp = header.stamp
    if hasattr(stamp, "sec"):
        return int(stamp.sec) * 10**9 + int(stamp.nanosec)
    return int(stamp.secs) * 10**9 + int(stamp.nsecs)
