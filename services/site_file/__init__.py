"""The site file on the disk: read with its calibration, written out, migrated. What it may say is in `models.config`."""
