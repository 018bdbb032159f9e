"""Training of the cause posterior, on simulated cases whose causes are known."""
