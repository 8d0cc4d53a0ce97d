"""What every process needs of its machine and of the bus: health, heartbeats, signals, CPU, memory, versions."""
