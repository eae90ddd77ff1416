"""``python -m robowidgets`` runs the command ``robowidgets``."""

import sys

from .command import main

sys.exit(main())
