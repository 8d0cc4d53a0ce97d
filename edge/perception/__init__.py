"""From a picture to the people in it, a file a stage."""
