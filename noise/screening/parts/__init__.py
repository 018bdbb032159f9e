"""Parts as they scatter: probability of each noise, sensitivities, advice."""
