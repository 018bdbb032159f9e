"""Random draws of effects for fits and for the training of posteriors."""
