"""From what is known of the cameras to a rig. Pure: no file, no clock, no network."""
