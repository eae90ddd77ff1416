"""The widget of a gas sensor."""

import struct
from pathlib import Path
from typing import Any

from robowidgets.widget.front_end import bundle
from robowidgets.widget.robot_widget import RobotWidget

from .samples import Gas, GasStatus, to_gas, to_status

_PPM = struct.Struct("<d")


class GasWidget(RobotWidget[Gas]):
    """The newest concentration in large type, with the status of the sensor."""

    _esm, _css = bundle("gas_widget", Path(__file__).parent / "static")
    sample_name = "gas"
    _status = GasStatus("")

    def update(self, message: Any) -> None:
        """Show a concentration in the next animation frame."""
        try:
            gas = to_gas(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._show(gas, self.frame_of(gas, self._status)[0])

    def status(self, message: Any) -> None:
        """Show a status with the newest concentration."""
        try:
            self._status = to_status(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._say_more()

    def frame_of(self, sample: Gas, status: GasStatus = _status) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"status": status.text}, self._pack(sample)

    def _texts_now(self) -> dict[str, Any]:
        return {"status": self._status.text}

    def _pack(self, sample: Gas) -> bytes:
        return _PPM.pack(sample.ppm)
