"""Pictures for the page: thinned where they are large, and what is in a part of them."""

from .packing import HEADER, Form, Packed, as_numbers, pack
from .region import checked_region, statistics

__all__ = ["HEADER", "Form", "Packed", "as_numbers", "checked_region", "pack", "statistics"]
