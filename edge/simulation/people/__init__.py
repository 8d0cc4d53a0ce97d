"""Who is on camera, body and clothes."""
