"""Whether recordings can be of the rig that its file describes: units, signs, order, conditions."""
