"""`kinebox doctor`: what is wrong with a machine, a configuration or a running box, how that is known, and what to do."""
