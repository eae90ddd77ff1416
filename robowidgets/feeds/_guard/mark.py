"""The mark that guards of this process carry in the network of a robot, so that they do not count as other programs."""

from __future__ import annotations

import secrets

MARK = f"robowidgets_guard_{secrets.token_hex(6)}"
"""The name of a guard's node, or its beginning. In DDS, it is part of the user data of its publishers."""

SERVER_ENDED = 75
"""The exit code of a guard that does not start because the server of its kernel has ended."""
