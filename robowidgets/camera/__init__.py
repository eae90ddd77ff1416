"""Readings of other sensors in the pictures of a camera."""

from .beside import BesidePictures, OnScan, PictureView, about_overlay
from .depth_scan import depth_rays, depth_scan
from .model import CameraModel
from .overlay import Overlay, ScanOnPicture, Seen, cones
from .place import NoTransformError, ground_frame, place_in_camera, pose_by_hand

__all__ = [
    "BesidePictures",
    "CameraModel",
    "NoTransformError",
    "OnScan",
    "Overlay",
    "PictureView",
    "ScanOnPicture",
    "Seen",
    "about_overlay",
    "cones",
    "depth_rays",
    "depth_scan",
    "ground_frame",
    "place_in_camera",
    "pose_by_hand",
]
