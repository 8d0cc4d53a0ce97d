"""Sources of pictures, one kind a file, behind the protocol in `source`."""
