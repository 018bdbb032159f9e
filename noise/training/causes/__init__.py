"""Simulated cases whose causes are known, for the diagnosis to learn from."""
