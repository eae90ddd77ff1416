"""The samples of a gas sensor, and the readers of its messages."""

from dataclasses import dataclass
from typing import Any

from robowidgets.messages.fields import describe, get, has, stamp_ns, unwrap
from robowidgets.samples import HasAge


@dataclass(frozen=True)
class Gas(HasAge):
    """The concentration of a gas in parts per million."""

    ppm: float
    stamp_ns: int | None = None


@dataclass(frozen=True)
class GasStatus(HasAge):
    """The status of a gas sensor, such as "warming up"."""

    text: str
    stamp_ns: int | None = None


def to_gas(message: Any) -> Gas:
    """Return the concentration in a gas_msgs/Gas."""
    message = unwrap(message)
    if isinstance(message, Gas):
        return message
    if not has(message, "ppm"):
        raise TypeError(f"expected a message like gas_msgs/Gas, got {describe(message)}")
    return Gas(float(get(message, "ppm")), stamp_ns(message))


def to_status(message: Any) -> GasStatus:
    """Return the status in a gas_msgs/GasStatus."""
    message = unwrap(message)
    if isinstance(message, GasStatus):
        return message
    if not has(message, "status"):
        raise TypeError(f"expected a message like gas_msgs/GasStatus, got {describe(message)}")
    return GasStatus(str(get(message, "status")), stamp_ns(message))
