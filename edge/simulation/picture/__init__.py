"""From a scene to what a camera sends."""
