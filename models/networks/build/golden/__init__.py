"""Golden vectors: what TensorFlow.js itself computes on real pictures, to hold the converted networks against."""
