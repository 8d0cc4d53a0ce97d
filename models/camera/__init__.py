"""Pinhole cameras, rigs of cameras and rigid transforms.

Frames of reference: the world is right-handed, in metres, z up, origin on the floor; a camera is OpenCV's, x right, y down,
z forward, with X_cam = R X_world + t.
"""
