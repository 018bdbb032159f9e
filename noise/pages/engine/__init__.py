"""The engine of every page: entries, clips, maps, figures and the template that holds them."""
