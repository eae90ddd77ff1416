"""The states of a message widget whose looks are kept."""

from __future__ import annotations

from math import nan

from robowidgets import MessageWidget

from ...looks import Look


def _message() -> MessageWidget:
    widget = MessageWidget(title="/battery")
    widget.update(
        {"header": {"frame_id": "base"}, "voltage": 16.21, "charge": nan, "cells": [4.05] * 4, "present": True}
    )
    return widget


def _fields() -> MessageWidget:
    widget = MessageWidget(title="/battery", fields=["voltage"])
    widget.update({"voltage": 16.21, "percentage": 0.867})
    return widget


LOOKS = {
    "message/empty": Look(make=lambda: MessageWidget(title="/battery")),
    "message/message": Look(make=_message),
    "message/fields": Look(make=_fields),
}
