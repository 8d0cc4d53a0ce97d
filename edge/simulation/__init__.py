"""The simulated gym: pupils who perform on camera, with the truth known.

Lesson plan -> scene (pupils, clothes, things, gym) -> renderer (what a real shutter sees) -> video and truth -> simulated source.
"""
