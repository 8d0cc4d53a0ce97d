"""Joints, limbs and their names."""
