"""Of the app: a rig that is heard while it is changed."""
