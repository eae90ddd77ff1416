"""The row of gas sensors."""

from robowidgets.kinds import Kind, Role

from .samples import Gas, GasStatus, to_gas, to_status


def _widget():
    from .gas_widget import GasWidget

    return GasWidget


STATUS = Kind(
    name="gas_status",
    sample_name="gas_status",
    noun="statuses of gas sensors",
    sample=GasStatus,
    read=to_status,
    types=frozenset({"gas_msgs/msg/GasStatus"}),
    nothing=GasStatus(""),
)
GAS = Kind(
    name="gas",  # of the kind and its widget
    sample_name="gas",  # moment.gas in recording.find
    noun="gas sensors",  # the plural in errors
    sample=Gas,
    read=to_gas,
    types=frozenset({"gas_msgs/msg/Gas"}),
    widget=_widget,  # called when it is first shown
    nothing=Gas(float("nan")),  # shown by a player before the first sample
    roles=(Role(name="gas"), Role(name="status", take="status", kind=STATUS)),
)
