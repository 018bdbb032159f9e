"""Analysis over many runs: regimes, critical speeds, stability, sweeps, sound power."""
