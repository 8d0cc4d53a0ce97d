"""From observations of several cameras to joints in 3D, live and smooth."""
