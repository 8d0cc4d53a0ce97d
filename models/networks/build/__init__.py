"""Set-up of the networks: fetch their weights, convert them to ONNX, make the golden vectors. Nothing here runs in a lesson."""
