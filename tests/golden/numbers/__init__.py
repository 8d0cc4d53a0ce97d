"""Measured values in words, which paper and page must write alike: `estimates.json` has values, sigmas, units and the texts."""
