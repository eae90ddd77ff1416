"""Pictures for the page: thinned where they are large, and what is in a part of them."""

from .packing import HEADER, Form, Packed, as_numbers, is_recolored, pack
from .region import checked_region, statistics

__all__ = ["HEADER", "Form", "Packed", "as_numbers", "checked_region", "is_recolored", "pack", "statistics"]
