"""What every process needs: health, logs, measuring."""
