"""Of the app: sounds compared blind, the votes, and the scale that they tell."""
