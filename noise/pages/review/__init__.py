"""The review: recordings, labels, screens and diagnoses on one page to look at and to listen to."""
