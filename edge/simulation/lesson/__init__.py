"""What happens in a simulated lesson: its plan, what a pupil does, what goes wrong with the cameras."""
