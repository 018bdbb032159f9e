"""Why a recording differs from its simulation: which effect is missing, and how far it closes."""
