"""What a camera sees of what other sensors measure."""

from .depth_scan import depth_rays, depth_scan
from .model import CameraModel
from .overlay import Drawn, Overlay, ScanOnPicture, cones
from .place import NoTransformError, ground_frame, place_in_camera, pose_by_hand

__all__ = [
    "CameraModel",
    "Drawn",
    "NoTransformError",
    "Overlay",
    "ScanOnPicture",
    "cones",
    "depth_rays",
    "depth_scan",
    "ground_frame",
    "place_in_camera",
    "pose_by_hand",
]
