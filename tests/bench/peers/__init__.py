"""Other people's systems, each in its own locked environment, run on the same keypoints in the same run."""
