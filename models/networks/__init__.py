"""The pose and detection networks: where their weights come from, what they take in and give out, and how they are converted."""
