"""Parts within their tolerances: probability of each noise, sensitivities, advice."""
