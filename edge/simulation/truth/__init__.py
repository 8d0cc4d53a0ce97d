"""What is true in a picture, and its file."""
