"""Of the app: samples, spectrogram and levels of a recording."""
