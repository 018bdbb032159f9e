"""Training cases: rigs, benches and causes as they are drawn."""
