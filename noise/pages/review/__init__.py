"""The review: recordings, labels, screens and diagnoses on one page to look at and to listen to.

`inputs` sorts what was named, `entries` reads what is to be heard, `clips` makes sounds of it that
fit into a page, `maps`, `screens` and `simulated` lay out conditions, `build` puts all together.
"""
