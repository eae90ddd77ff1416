"""Pictures for the page, thinned if they are large, and statistics of a part of a picture."""

from .packing import HEADER, Form, Packed, as_numbers, is_recolored, pack
from .region import checked_region, statistics

__all__ = ["HEADER", "Form", "Packed", "as_numbers", "checked_region", "is_recolored", "pack", "statistics"]
