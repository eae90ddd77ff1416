"""``python -m robowidgets`` is the command ``robowidgets``."""

import sys

from .command import main

sys.exit(main())
