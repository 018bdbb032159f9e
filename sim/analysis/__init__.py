"""What a rig does over many runs: regimes, critical speeds, stability, sweeps."""
