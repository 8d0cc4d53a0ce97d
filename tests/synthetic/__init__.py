"""A person with rigid limbs in a gym with cameras: ground truth for fusion."""
