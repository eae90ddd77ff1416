"""The mark of what guards of this process have in the network of a robot: they are not other programs."""

from __future__ import annotations

import secrets

MARK = f"robowidgets_guard_{secrets.token_hex(6)}"
"""The name of the nodes of guards, or its beginning; in DDS, a part of the user data of their publishers."""

SERVER_ENDED = 75
"""The exit code of a guard that does not start because the server of its kernel has ended."""
